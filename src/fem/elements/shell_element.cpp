#include "mottle/fem/elements/shell_element.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "fem/elements/shell_form.hpp"
#include "fem/elements/shell_materials.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/elements/laminate.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/finite_element_model.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::fem {
namespace {

constexpr double k_radian = std::numbers::pi / 180.0;

std::string_view card_of(const ShellElement& element) {
  if (element.card != nullptr) return element.card;
  switch (element.node_count) {
    case 3:
      return "CTRIA3";
    case 6:
      return "CTRIA6";
    case 8:
      return "CQUAD8";
    default:
      return "CQUAD4";
  }
}

/// A face with the middles of its edges as a linear cell where one of them is left out.
const Topology& topology_of(const ShellElement& element) {
  static const Topology k_triangle = {.cell = VtkCell::triangle, .cell_nodes = {0, 1, 2}, .faces = {{0, 1, 2}}};
  static const Topology k_quadrilateral = {
      .cell = VtkCell::quadrilateral, .cell_nodes = {0, 1, 2, 3}, .faces = {{0, 1, 2, 3}}};
  static const Topology k_quadratic_triangle = {
      .cell = VtkCell::quadratic_triangle, .cell_nodes = {0, 1, 2, 3, 4, 5}, .faces = {{0, 1, 2}}};
  static const Topology k_quadratic_quadrilateral = {
      .cell = VtkCell::quadratic_quadrilateral, .cell_nodes = {0, 1, 2, 3, 4, 5, 6, 7}, .faces = {{0, 1, 2, 3}}};
  const bool is_triangle = element.node_count == 3 || element.node_count == 6;
  if (!is_curved(element) || std::ranges::find(shell_nodes(element), -1) != shell_nodes(element).end())
    return is_triangle ? k_triangle : k_quadrilateral;
  return is_triangle ? k_quadratic_triangle : k_quadratic_quadrilateral;
}

/// Adds matrix with its coefficient, which rests on more fields than its own.
void add_stiffness(ElementPieces& result, Coefficient coefficient, double factor, const std::vector<FieldIndex>& fields,
                   const Eigen::MatrixXd& matrix) {
  coefficient.matrix_fields.insert(coefficient.matrix_fields.end(), fields.begin(), fields.end());
  add_piece(result, ElementPiece::Kind::stiffness, factor, coefficient, matrix);
}

const Material* find_material(const FiniteElementModel& model, int index) {
  return index < 0 ? nullptr : &model.materials[static_cast<std::size_t>(index)];
}

FieldIndex thickness_of(const FiniteElementModel& model, const ShellElement& element) {
  if (element.thickness != k_no_field) return element.thickness;
  return model.shell_properties[static_cast<std::size_t>(element.property)].thickness;
}

/// The materials of a PSHELL with their moduli; those that it leaves blank are absent.
struct PlateMaterials {
  const Material *membrane = nullptr, *bending = nullptr, *transverse = nullptr;
  std::optional<PlaneStress> stretching = {}, curving = {};
  std::optional<TransverseShear> shear = {};
};

PlateMaterials plate_materials(const FiniteElementModel& model, const ShellProperty& property) {
  PlateMaterials materials{.membrane = find_material(model, property.membrane_material),
                           .bending = find_material(model, property.bending_material)};
  if (materials.membrane != nullptr) materials.stretching = plane_stress_of(model, *materials.membrane);
  if (materials.bending == nullptr) return materials;
  materials.curving = plane_stress_of(model, *materials.bending);
  materials.transverse = find_material(model, property.shear_material);
  if (materials.transverse != nullptr) materials.shear = transverse_shear_of(model, *materials.transverse);
  return materials;
}

/// The fields besides the coefficients' own on which the edges' fraction of bending and the bubbles depend, with t^2 E
/// / G: the pieces hold at the card's values only.
std::vector<FieldIndex> ratio_fields(PlateMaterials materials, FieldIndex thickness, bool of_bubbles) {
  if (!of_bubbles) materials.membrane = nullptr;
  std::vector<FieldIndex> fields = {thickness};
  const Material* first = materials.bending;
  const bool is_one = (materials.membrane == nullptr || materials.membrane == first) &&
                      (materials.transverse == nullptr || materials.transverse == first);
  if (is_one && first->kind == Material::Kind::isotropic && (first->shear == k_no_field || first->young == k_no_field))
    return fields;
  for (const Material* one : {materials.membrane, materials.bending, materials.transverse}) {
    if (one == nullptr) continue;
    for (const FieldIndex field : fields_of(*one)) fields.push_back(field);
  }
  return fields;
}

/// Coefficients of bending over those of shear and of the membrane; 0 where there is no such.
std::pair<double, double> current_ratios(const FiniteElementModel& model, const ShellElement& element,
                                         const PlateMaterials& materials) {
  if (!materials.curving) return {0.0, 0.0};
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const double t = model.value(thickness_of(model, element));
  const double bending = value_of(model, materials.curving->modulus) * property.bending_ratio * t * t;
  const double shear = materials.shear ? value_of(model, materials.shear->modulus) * property.shear_ratio : 0.0;
  const double membrane = materials.stretching ? value_of(model, materials.stretching->modulus) : 0.0;
  return {shear > 0.0 ? bending / shear : 0.0, membrane > 0.0 ? bending / membrane : 0.0};
}

void add_plate_stiffness(const FiniteElementModel& model, const ShellElement& element, ElementPieces& result) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex thickness = thickness_of(model, element);
  const PlateMaterials materials = plate_materials(model, property);
  const auto& [membrane, bending, transverse, stretching, curving, shear] = materials;
  ShellSection section;
  if (stretching) section.membrane = stretching->unit;
  if (curving) section.bending = curving->unit / 12.0;
  if (shear) section.shear = shear->unit;
  auto [over_shear, over_membrane] = current_ratios(model, element, materials);
  std::vector<FieldIndex> plate_fields;
  if (element.bending_over_shear > 0.0) over_shear = element.bending_over_shear;
  if (element.bending_over_membrane > 0.0) over_membrane = element.bending_over_membrane;
  const bool is_held = is_curved(element) ? element.bending_over_membrane > 0.0 : element.bending_over_shear > 0.0;
  if (!is_held && curving && (shear || is_curved(element)))
    plate_fields = ratio_fields(materials, thickness, is_curved(element));
  if (over_shear > 0.0) section.bending_over_shear = over_shear;
  if (over_membrane > 0.0) section.bending_over_membrane = over_membrane;
  const ShellStiffness pieces = plate_stiffness(model, element, section);
  if (stretching) {
    add_stiffness(result, times(stretching->modulus, thickness), 1.0,
                  is_curved(element) ? plate_fields : std::vector<FieldIndex>(), pieces.membrane);
    add_stiffness(result, times(stretching->drilling, thickness), model.settings.drilling,
                  stretching->modulus.matrix_fields, pieces.drilling);
  }
  if (curving)
    add_stiffness(result, times(curving->modulus, thickness, 3), property.bending_ratio, plate_fields, pieces.bending);
  if (shear) add_stiffness(result, times(shear->modulus, thickness), property.shear_ratio, plate_fields, pieces.shear);
}

/// A PSHELL with MID4: membrane, bending and their coupling cannot be told apart any more.
void add_coupled_stiffness(const FiniteElementModel& model, const ShellElement& element, ElementPieces& result) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex thickness = thickness_of(model, element);
  const double t = model.value(thickness);
  const PlateMaterials materials = plate_materials(model, property);
  const Material& coupling = *find_material(model, property.coupling_material);
  const auto matrix_of = [&](const PlaneStress& plane) {
    return Eigen::Matrix3d(value_of(model, plane.modulus) * plane.unit);
  };
  // Nastran's curvature is positive where the side of the normal is pressed, hence the sign.
  ShellSection section{.membrane = t * matrix_of(*materials.stretching),
                       .coupling = -t * t * matrix_of(plane_stress_of(model, coupling)),
                       .bending = t * t * t * property.bending_ratio / 12.0 * matrix_of(*materials.curving)};
  if (materials.shear)
    section.shear = t * property.shear_ratio * value_of(model, materials.shear->modulus) * materials.shear->unit;
  const Eigen::Matrix3d own = section.bending - section.coupling * section.membrane.ldlt().solve(section.coupling);
  const Eigen::Matrix3d symmetric = 0.5 * (own + own.transpose());
  require(SymmetricEigen(symmetric).eigenvalues()(0) >= -1e-9 * section.bending.norm(),
          "MID4 couples membrane and bending so much that some deformation gives energy away; T^2 G4 G1^-1 G4 may not "
          "exceed (12I/T3) T^2 G2 / 12");
  const LaminateStiffness pieces = laminate_stiffness(model, element, section);
  std::vector<FieldIndex> fields = {thickness};
  for (const Material* one : {materials.membrane, materials.bending, materials.transverse, &coupling}) {
    if (one == nullptr) continue;
    for (const FieldIndex field : fields_of(*one)) fields.push_back(field);
  }
  add_stiffness(result, {}, 1.0, fields, pieces.section);
  add_stiffness(result, times(materials.stretching->drilling, thickness), model.settings.drilling,
                materials.stretching->modulus.matrix_fields, pieces.drilling);
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

void add_laminate_stiffness(const FiniteElementModel& model, const ShellElement& element,
                            const LaminateProperty& laminate, ElementPieces& result) {
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
  const LaminateStiffness pieces = laminate_stiffness(model, element, section);
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
  add_degrees_of_freedom(element, result);
  add_mass(model, property, thickness_of(model, element), unit_mass(model, element), result);
  if (selection == PieceSelection::mass) return;
  if (property.coupling_material >= 0) {
    add_coupled_stiffness(model, element, result);
  } else if (property.laminate.plies.empty()) {
    add_plate_stiffness(model, element, result);
  } else {
    add_laminate_stiffness(model, element, property.laminate, result);
  }
}

}  // namespace

void hold_ratios(const FiniteElementModel& model, ShellElement& element) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  if (!property.laminate.plies.empty()) return;
  std::tie(element.bending_over_shear, element.bending_over_membrane) =
      current_ratios(model, element, plate_materials(model, property));
}

const ElementTraits<ShellElement> ShellElement::k_traits = {
    .card = card_of,
    .nodes = shell_nodes,
    .topology = topology_of,
    .add_pieces = add_shell,
    .family = "shells",
    .quality = shell_quality_of,
    .geometry = {.cards = {"CQUAD4", "CTRIA3", "CQUADR", "CTRIAR", "CQUAD8", "CTRIA6"},
                 .names = {"ZOFFS"},
                 .at = [](ShellElement& element, int) -> double& { return element.offset; }}};

}  // namespace mottle::fem
