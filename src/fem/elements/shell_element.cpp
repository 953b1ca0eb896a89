#include "mottle/fem/elements/shell_element.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "fem/elements/shell_materials.hpp"
#include "mottle/fem/elements/laminate.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

constexpr double k_radian = std::numbers::pi / 180.0;

std::string_view card_of(const ShellElement& element) {
  return element.node_count == 3 ? "CTRIA3" : "CQUAD4";
}

std::span<const int> shell_nodes(const ShellElement& element) {
  return std::span(element.nodes).first(static_cast<std::size_t>(element.node_count));
}

const Topology& topology_of(const ShellElement& element) {
  static const Topology k_triangle = {.cell = VtkCell::triangle, .cell_nodes = {0, 1, 2}, .faces = {{0, 1, 2}}};
  static const Topology k_quadrilateral = {
      .cell = VtkCell::quadrilateral, .cell_nodes = {0, 1, 2, 3}, .faces = {{0, 1, 2, 3}}};
  return element.node_count == 3 ? k_triangle : k_quadrilateral;
}

bool depends_on_direction(const FiniteElementModel& model, const ShellProperty& property) {
  const auto does = [&](int material) {
    return material >= 0 && model.materials[static_cast<std::size_t>(material)].kind != Material::Kind::isotropic;
  };
  return does(property.membrane_material) || does(property.bending_material) || does(property.shear_material) ||
         std::ranges::any_of(property.laminate.plies, does, &ShellPly::material);
}

ShellInput shell_input(const FiniteElementModel& model, const ShellElement& element) {
  ShellInput input{.node_count = element.node_count, .offset = element.offset};
  input.nodes.leftCols(element.node_count) = positions(model, shell_nodes(element));
  // What is isotropic needs no direction, and must not fail for one that cannot be projected.
  if (!depends_on_direction(model, model.shell_properties[static_cast<std::size_t>(element.property)])) return input;
  input.material_angle = element.material_angle * k_radian;
  if (element.material_system == ShellElement::k_by_angle) return input;
  input.material_direction = Eigen::Vector3d::UnitX();
  if (element.material_system >= 0) {
    const Eigen::Vector3d centre = input.nodes.leftCols(element.node_count).rowwise().mean();
    const auto system = static_cast<std::size_t>(element.material_system);
    input.material_direction = model.coordinate_systems[system].directions_at(centre).col(0);
  }
  return input;
}

ElementQuality quality_of(const FiniteElementModel& model, const ShellElement& element) {
  const ShellQuality quality = shell_quality(shell_input(model, element));
  return {quality.jacobian_ratio, quality.aspect, quality.warp};
}

/// Adds matrix with its coefficient, which rests on more fields than its own.
void add_stiffness(ElementPieces& result, Coefficient coefficient, double factor, const std::vector<FieldIndex>& fields,
                   const ShellMatrix& matrix) {
  coefficient.matrix_fields.insert(coefficient.matrix_fields.end(), fields.begin(), fields.end());
  const auto size = static_cast<Eigen::Index>(result.degrees_of_freedom.size());
  add_piece(result, ElementPiece::Kind::stiffness, factor, coefficient, matrix.topLeftCorner(size, size));
}

const Material* find_material(const FiniteElementModel& model, int index) {
  return index < 0 ? nullptr : &model.materials[static_cast<std::size_t>(index)];
}

/// The fields besides the coefficients' own on which the edges' fraction of bending depends, with t^2 E / G: the two
/// pieces of the plate hold at the card's values only.
std::vector<FieldIndex> edge_fields(const Material& bending, const Material& shear, FieldIndex thickness) {
  std::vector<FieldIndex> fields = {thickness};
  const bool is_one_isotropic = &bending == &shear && shear.kind == Material::Kind::isotropic &&
                                (shear.shear == k_no_field || shear.young == k_no_field);
  if (is_one_isotropic) return fields;
  for (const Material* one : {&bending, &shear}) {
    for (const FieldIndex field : fields_of(*one)) fields.push_back(field);
  }
  return fields;
}

FieldIndex thickness_of(const FiniteElementModel& model, const ShellElement& element) {
  if (element.thickness != k_no_field) return element.thickness;
  return model.shell_properties[static_cast<std::size_t>(element.property)].thickness;
}

double current_bending_over_shear(const FiniteElementModel& model, const ShellElement& element,
                                  const Coefficient& bending, const Coefficient& shear) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const double t = model.value(thickness_of(model, element));
  return value_of(model, bending) * property.bending_ratio * t * t / (value_of(model, shear) * property.shear_ratio);
}

void add_plate_stiffness(const FiniteElementModel& model, const ShellElement& element, const ShellInput& input,
                         ElementPieces& result) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex thickness = thickness_of(model, element);
  const Material* membrane_material = find_material(model, property.membrane_material);
  const Material* bending_material = find_material(model, property.bending_material);
  const Material* shear_material =
      bending_material == nullptr ? nullptr : find_material(model, property.shear_material);
  ShellSection section;
  PlaneStress membrane, bending;
  if (membrane_material != nullptr) {
    membrane = plane_stress_of(model, *membrane_material);
    section.membrane = membrane.unit;
  }
  if (bending_material != nullptr) {
    bending = plane_stress_of(model, *bending_material);
    section.bending = bending.unit / 12.0;
  }
  std::optional<TransverseShear> shear;
  if (shear_material != nullptr) shear = transverse_shear_of(model, *shear_material);
  std::vector<FieldIndex> plate_fields;
  if (shear) {
    section.shear = shear->unit;
    section.bending_over_shear = element.bending_over_shear;
    if (element.bending_over_shear == 0.0) {
      section.bending_over_shear = current_bending_over_shear(model, element, bending.modulus, shear->modulus);
      plate_fields = edge_fields(*bending_material, *shear_material, thickness);
    }
  }
  const ShellPieces pieces = shell_stiffness(input, section);
  if (membrane_material != nullptr) {
    add_stiffness(result, times(membrane.modulus, thickness), 1.0, {}, pieces.membrane);
    add_stiffness(result, times(membrane.drilling, thickness), model.settings.drilling, membrane.modulus.matrix_fields,
                  pieces.drilling);
  }
  if (bending_material != nullptr)
    add_stiffness(result, times(bending.modulus, thickness, 3), property.bending_ratio, plate_fields, pieces.bending);
  if (shear) add_stiffness(result, times(shear->modulus, thickness), property.shear_ratio, plate_fields, pieces.shear);
}

/// The plies with what they are multiplied by: Young's modulus of the only, isotropic material, or one.
struct Plies {
  std::vector<LaminatePly> plies = {};
  Coefficient modulus = {};
};

Plies plies_of(const FiniteElementModel& model, const LaminateProperty& laminate) {
  Plies result;
  const auto material_of = [&](const ShellPly& ply) -> const Material& {
    return model.materials[static_cast<std::size_t>(ply.material)];
  };
  const Material& first = material_of(laminate.plies.front());
  bool is_uniform = first.kind == Material::Kind::isotropic;
  for (const ShellPly& ply : laminate.plies) is_uniform = is_uniform && &material_of(ply) == &first;
  std::vector<FieldIndex>& fields = result.modulus.matrix_fields;
  if (is_uniform) result.modulus = plane_stress_of(model, first).modulus;
  // Young's modulus stands in front of all, so that the shear flexibility is relative to it.
  if (is_uniform && first.shear != k_no_field) fields.insert(fields.end(), {first.young, first.shear});
  for (const ShellPly& ply : laminate.plies) {
    const Material& material = material_of(ply);
    const PlaneStress plane = plane_stress_of(model, material);
    const double modulus = value_of(model, plane.modulus);
    result.plies.push_back({.elasticity = (is_uniform ? 1.0 : modulus) * plane.unit,
                            .shear_flexibility = (is_uniform ? modulus : 1.0) * shear_flexibility_of(model, material),
                            .thickness = model.value(ply.thickness),
                            .angle = model.value(ply.angle) * k_radian});
    for (const FieldIndex field : {ply.thickness, ply.angle}) fields.push_back(field);
    if (is_uniform) continue;
    for (const FieldIndex field : fields_of(material)) fields.push_back(field);
  }
  fields.push_back(laminate.bottom);
  return result;
}

void add_laminate_stiffness(const FiniteElementModel& model, const LaminateProperty& laminate, const ShellInput& input,
                            ElementPieces& result) {
  const Plies plies = plies_of(model, laminate);
  double thickness = 0.0;
  for (const LaminatePly& ply : plies.plies) thickness += ply.thickness;
  ShellSection section = laminate_section(plies.plies, model.value(laminate.bottom, -0.5 * thickness));
  using enum LaminateProperty::Option;
  if (laminate.option != whole) section.coupling.setZero();
  if (laminate.option == membrane) section.bending.setZero();
  if (laminate.option == smeared) section.bending = thickness * thickness / 12.0 * section.membrane;
  if (laminate.option == bending) section.membrane.setZero();
  if (laminate.option == membrane || laminate.option == smeared) section.shear.setZero();
  const LaminatePieces pieces = laminate_stiffness(input, section);
  add_stiffness(result, plies.modulus, 1.0, {}, pieces.section);
  add_stiffness(result, plies.modulus, model.settings.drilling * section.membrane(2, 2), {}, pieces.drilling);
}

void add_mass(const FiniteElementModel& model, const ShellProperty& property, FieldIndex thickness,
              const Eigen::MatrixXd& unit, ElementPieces& result) {
  const double weigh = model.settings.mass_factor;
  const auto add = [&](int material, FieldIndex thick, double times_it) {
    const FieldIndex density = model.materials[static_cast<std::size_t>(material)].density;
    add_piece(result, ElementPiece::Kind::mass, weigh * times_it, times(times({}, density), thick), unit);
  };
  std::map<std::pair<int, FieldIndex>, int> plies;  // those of one material and one thickness together
  for (const ShellPly& ply : property.laminate.plies) ++plies[{ply.material, ply.thickness}];
  for (const auto& [ply, count] : plies) add(ply.first, ply.second, count);
  if (property.membrane_material >= 0) add(property.membrane_material, thickness, 1.0);
  add_piece(result, ElementPiece::Kind::mass, weigh, times({}, property.nonstructural_mass), unit);
}

void add_shell(const FiniteElementModel& model, const ShellElement& element, PieceSelection selection,
               ElementPieces& result) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const ShellInput input = shell_input(model, element);
  for (const int node : shell_nodes(element)) add_six_degrees_of_freedom(node, result);
  const auto size = static_cast<Eigen::Index>(6 * element.node_count);
  add_mass(model, property, thickness_of(model, element), shell_mass(input, mass_kind(model)).topLeftCorner(size, size),
           result);
  if (selection == PieceSelection::mass) return;
  if (property.laminate.plies.empty()) {
    add_plate_stiffness(model, element, input, result);
  } else {
    add_laminate_stiffness(model, property.laminate, input, result);
  }
}

}  // namespace

double bending_over_shear(const FiniteElementModel& model, const ShellElement& element) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  if (property.bending_material < 0 || property.shear_material < 0) return 0.0;
  const auto shear = transverse_shear_of(model, *find_material(model, property.shear_material));
  if (!shear) return 0.0;
  const PlaneStress bending = plane_stress_of(model, *find_material(model, property.bending_material));
  return current_bending_over_shear(model, element, bending.modulus, shear->modulus);
}

const ElementTraits<ShellElement> ShellElement::k_traits = {
    .card = card_of,
    .nodes = shell_nodes,
    .topology = topology_of,
    .add_pieces = add_shell,
    .family = "shells",
    .quality = quality_of,
    .geometry = {.cards = {"CQUAD4", "CTRIA3"}, .names = {"ZOFFS"}, .at = [](ShellElement& element, int) -> double& {
                   return element.offset;
                 }}};

}  // namespace mottle::fem
