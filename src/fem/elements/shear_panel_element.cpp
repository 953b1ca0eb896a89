#include "mottle/fem/elements/shear_panel_element.hpp"

#include "fem/assembly/constraint_equations.hpp"
#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "mottle/fem/elements/shear_panel.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

const Topology& topology_of(const ShearPanelElement&) {
  static const Topology k_panel = {.cell = VtkCell::quadrilateral, .cell_nodes = {0, 1, 2, 3}, .faces = {{0, 1, 2, 3}}};
  return k_panel;
}

/// Translations of the shell's unit mass.
Eigen::MatrixXd unit_mass(const FiniteElementModel& model, const PanelNodes& nodes) {
  ShellInput input;
  input.nodes = nodes;
  const ShellMatrix mass = shell_mass(input, mass_kind(model));
  Eigen::MatrixXd translations(12, 12);
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = 0; j < 4; ++j) translations.block<3, 3>(3 * i, 3 * j) = mass.block<3, 3>(6 * i, 6 * j);
  }
  return translations;
}

/// Rods along the edges, [12 x 12] at unit E: those of a fraction of the width by t, those of a width in t by t^2.
std::array<PanelMatrix, 2> edge_rods(const ShearPanelElement& element, const PanelNodes& nodes) {
  std::array<PanelMatrix, 2> rods = {PanelMatrix::Zero(), PanelMatrix::Zero()};
  const auto side = [&](Eigen::Index edge) { return Eigen::Vector3d(nodes.col((edge + 1) % 4) - nodes.col(edge)); };
  for (Eigen::Index edge = 0; edge < 4; ++edge) {
    const double f = element.effectiveness[static_cast<std::size_t>(edge % 2)], length = side(edge).norm();
    constexpr double k_largest_fraction = 1.01;  // as Nastran tells the two meanings apart
    const bool is_fraction = f <= k_largest_fraction;
    const double area = is_fraction ? f * shear_panel_area(nodes) / (length + side((edge + 2) % 4).norm()) : 0.5 * f;
    Eigen::Matrix<double, 12, 1> stretch = Eigen::Matrix<double, 12, 1>::Zero();
    stretch.segment<3>(3 * ((edge + 1) % 4)) = side(edge) / length;
    stretch.segment<3>(3 * edge) = -side(edge) / length;
    rods[is_fraction ? 0 : 1] += area / length * stretch * stretch.transpose();
  }
  return rods;
}

void add_panel(const FiniteElementModel& model, const ShearPanelElement& element, PieceSelection selection,
               ElementPieces& result) {
  for (const int node : element.nodes) {
    for (int c = 0; c < 3; ++c) result.degrees_of_freedom.push_back(degree_of_freedom(node, c));
  }
  const PanelNodes nodes = positions(model, element.nodes);
  const Material& material = model.materials[static_cast<std::size_t>(element.material)];
  const Eigen::MatrixXd mass = unit_mass(model, nodes);
  const double weigh = model.settings.mass_factor;
  add_piece(result, ElementPiece::Kind::mass, weigh, times(times({}, material.density), element.thickness), mass);
  add_piece(result, ElementPiece::Kind::mass, weigh, times({}, element.nonstructural_mass), mass);
  if (selection == PieceSelection::mass) return;
  Coefficient shear = times(shear_coefficient(model, material), element.thickness);
  for (const FieldIndex field : poisson_fields(material)) shear.matrix_fields.push_back(field);
  add_piece(result, ElementPiece::Kind::stiffness, 1.0, shear,
            shear_panel_stiffness(nodes, poisson_ratio(model, material)));
  const auto rods = edge_rods(element, nodes);
  for (const int power : {1, 2}) {
    const PanelMatrix& matrix = rods[static_cast<std::size_t>(power - 1)];
    if (matrix.isZero(0.0)) continue;
    add_piece(result, ElementPiece::Kind::stiffness, 1.0,
              times(young_coefficient(model, material), element.thickness, power), matrix);
  }
}

}  // namespace

const ElementTraits<ShearPanelElement> ShearPanelElement::k_traits = {
    .card = [](const ShearPanelElement&) -> std::string_view { return "CSHEAR"; },
    .nodes = nodes_of<ShearPanelElement>,
    .topology = topology_of,
    .add_pieces = add_panel};

}  // namespace mottle::fem
