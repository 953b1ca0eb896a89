#include "mottle/fem/elements/scalar_element.hpp"

#include "fem/assembly/constraint_equations.hpp"
#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

std::string_view card_of(const ScalarElement& element) {
  static constexpr const char* k_names[] = {"CELAS", "CMASS", "CDAMP"};
  return k_names[static_cast<std::size_t>(element.kind)];
}

/// Only springs are drawn.
const Topology& topology_of(const ScalarElement& element) {
  static const Topology k_unseen = {.cell = VtkCell::line, .cell_nodes = {0, 1}};
  return element.kind == ScalarElement::Kind::spring ? line_topology(element) : k_unseen;
}

void add_scalar(const FiniteElementModel& model, const ScalarElement& element, PieceSelection selection,
                ElementPieces& result) {
  static constexpr ElementPiece::Kind k_kinds[] = {ElementPiece::Kind::stiffness, ElementPiece::Kind::mass,
                                                   ElementPiece::Kind::damping};
  const ElementPiece::Kind kind = k_kinds[static_cast<std::size_t>(element.kind)];
  if (selection == PieceSelection::mass && kind != ElementPiece::Kind::mass) return;
  if (element.value == k_no_field) return;  // blank is zero
  result.is_basic = false;
  for (std::size_t end = 0; end < 2; ++end) {
    if (element.nodes[end] >= 0) {
      result.degrees_of_freedom.push_back(degree_of_freedom(element.nodes[end], element.components[end]));
    }
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(1, 1);
  if (result.degrees_of_freedom.size() == 2) {
    matrix.resize(2, 2);
    matrix << 1.0, -1.0, -1.0, 1.0;
  }
  const double factor = kind == ElementPiece::Kind::mass ? model.settings.mass_factor : 1.0;
  result.pieces.push_back({kind, factor, {{element.value, 1}}, {}, matrix});
}

}  // namespace

const ElementTraits<ScalarElement> ScalarElement::k_traits = {
    .card = card_of, .nodes = nodes_of<ScalarElement>, .topology = topology_of, .add_pieces = add_scalar};

}  // namespace mottle::fem
