#include "mottle/fem/elements/shell_element.hpp"

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

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

ShellInput shell_input(const FiniteElementModel& model, const ShellElement& element) {
  ShellInput input{.node_count = element.node_count, .offset = element.offset};
  input.nodes.leftCols(element.node_count) = positions(model, shell_nodes(element));
  return input;
}

ElementQuality quality_of(const FiniteElementModel& model, const ShellElement& element) {
  const ShellQuality quality = shell_quality(shell_input(model, element));
  return {quality.jacobian_ratio, quality.aspect, quality.warp};
}

void add_shell_stiffness(const FiniteElementModel& model, const ShellProperty& property, FieldIndex thickness,
                         ShellInput input, ElementPieces& result) {
  const auto size = static_cast<Eigen::Index>(6 * input.node_count);
  const auto material = [&](int index) -> const Material* {
    return index < 0 ? nullptr : &model.materials[static_cast<std::size_t>(index)];
  };
  const Material* membrane = material(property.membrane_material);
  const Material* bending = material(property.bending_material);
  const Material* shear = material(property.shear_material);
  if (membrane != nullptr) input.poisson_membrane = poisson_ratio(model, *membrane);
  if (bending != nullptr) input.poisson_bending = poisson_ratio(model, *bending);
  // A triangle's fraction of bending depends on t^2 E / G: its two pieces hold at the card's values only.
  std::vector<FieldIndex> plate_fields = bending == nullptr ? std::vector<FieldIndex>{} : poisson_fields(*bending);
  if (input.node_count == 3 && bending != nullptr && shear != nullptr) {
    plate_fields.push_back(thickness);
    if (bending != shear || (shear->shear != k_no_field && shear->young != k_no_field)) {
      for (const Material* one : {bending, shear}) {
        for (const FieldIndex field : {one->young, one->shear, one->poisson}) plate_fields.push_back(field);
      }
    }
  }
  if (bending != nullptr && shear != nullptr) {
    const Coefficient young = young_coefficient(model, *bending);
    const Coefficient modulus = shear_coefficient(model, *shear);
    const double t = model.value(thickness);
    const double nu = input.poisson_bending;
    input.shear_flexibility = value_of(model, young) * property.bending_ratio * t * t /
                              (12.0 * (1.0 - nu * nu) * value_of(model, modulus) * property.shear_ratio);
  }
  const ShellPieces pieces = shell_stiffness(input);
  const auto add = [&](Coefficient coefficient, double factor, const std::vector<FieldIndex>& matrix_fields,
                       const ShellMatrix& matrix) {
    for (const FieldIndex field : matrix_fields) coefficient.matrix_fields.push_back(field);
    result.pieces.push_back({ElementPiece::Kind::stiffness, factor * coefficient.factor, coefficient.fields,
                             coefficient.matrix_fields, matrix.topLeftCorner(size, size)});
  };
  if (membrane != nullptr) {
    const std::vector<FieldIndex> matrix_fields = poisson_fields(*membrane);
    add(times(young_coefficient(model, *membrane), thickness), 1.0, matrix_fields, pieces.membrane);
    add(times(shear_coefficient(model, *membrane), thickness), model.settings.drilling, matrix_fields, pieces.drilling);
  }
  if (bending != nullptr) {
    add(times(young_coefficient(model, *bending), thickness, 3), property.bending_ratio, plate_fields, pieces.bending);
  }
  if (bending != nullptr && shear != nullptr) {
    add(times(shear_coefficient(model, *shear), thickness), property.shear_ratio, plate_fields, pieces.shear);
  }
}

void add_shell(const FiniteElementModel& model, const ShellElement& element, PieceSelection selection,
               ElementPieces& result) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex thickness = element.thickness != k_no_field ? element.thickness : property.thickness;
  const ShellInput input = shell_input(model, element);
  for (const int node : shell_nodes(element)) add_six_degrees_of_freedom(node, result);
  const auto size = static_cast<Eigen::Index>(6 * element.node_count);
  const Eigen::MatrixXd mass = shell_mass(input, mass_kind(model)).topLeftCorner(size, size);
  if (property.membrane_material >= 0) {
    const FieldIndex density = model.materials[static_cast<std::size_t>(property.membrane_material)].density;
    if (density != k_no_field) {
      result.pieces.push_back(
          {ElementPiece::Kind::mass, model.settings.mass_factor, {{density, 1}, {thickness, 1}}, {}, mass});
    }
  }
  if (property.nonstructural_mass != k_no_field) {
    result.pieces.push_back(
        {ElementPiece::Kind::mass, model.settings.mass_factor, {{property.nonstructural_mass, 1}}, {}, mass});
  }
  if (selection == PieceSelection::all) add_shell_stiffness(model, property, thickness, input, result);
}

}  // namespace

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
