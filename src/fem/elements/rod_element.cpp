#include "mottle/fem/elements/rod_element.hpp"

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "mottle/fem/elements/beam.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

void add_rod(const FiniteElementModel& model, const RodElement& element, PieceSelection selection,
             ElementPieces& result) {
  for (const int node : element.nodes) add_six_degrees_of_freedom(node, result);
  const std::array<Eigen::Vector3d, 2> nodes = ends_of(model, element.nodes);
  const Material& material = model.materials[static_cast<std::size_t>(element.material)];
  const BeamMatrix unit = rod_mass(nodes, mass_kind(model));
  const double weigh = model.settings.mass_factor;
  add_piece(result, ElementPiece::Kind::mass, weigh, times(times({}, material.density), element.area), unit);
  add_piece(result, ElementPiece::Kind::mass, weigh, times({}, element.nonstructural_mass), unit);
  if (selection == PieceSelection::mass) return;
  for (const BeamPiece& piece : rod_stiffness(nodes)) {
    const Coefficient coefficient = piece.coefficient == BeamCoefficient::EA
                                        ? times(young_coefficient(model, material), element.area)
                                        : times(shear_coefficient(model, material), element.torsion);
    add_piece(result, ElementPiece::Kind::stiffness, 1.0, coefficient, piece.matrix);
  }
}

}  // namespace

const ElementTraits<RodElement> RodElement::k_traits = {
    .card = [](const RodElement&) -> std::string_view { return "CROD"; },
    .counted_as = "CROD, CONROD",
    .nodes = nodes_of<RodElement>,
    .topology = line_topology<RodElement>,
    .add_pieces = add_rod};

}  // namespace mottle::fem
