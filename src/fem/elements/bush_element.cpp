#include "mottle/fem/elements/bush_element.hpp"

#include "fem/assembly/rigid_motion.hpp"
#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

void add_bush(const FiniteElementModel& model, const BushElement& element, PieceSelection selection,
              ElementPieces& result) {
  if (selection == PieceSelection::mass) return;
  const auto arm = [&](int node) {
    return Eigen::Vector3d(element.location - model.nodes[static_cast<std::size_t>(node)].position);
  };
  add_six_degrees_of_freedom(element.nodes[0], result);
  Eigen::MatrixXd motion = -rigid_motion(element.axes, arm(element.nodes[0]));
  if (element.nodes[1] >= 0) {
    add_six_degrees_of_freedom(element.nodes[1], result);
    motion.conservativeResize(6, 12);
    motion.rightCols(6) = rigid_motion(element.axes, arm(element.nodes[1]));
  }
  for (Eigen::Index c = 0; c < 6; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const Eigen::MatrixXd matrix = motion.row(c).transpose() * motion.row(c);
    if (element.stiffness[k] != k_no_field) {
      result.pieces.push_back({ElementPiece::Kind::stiffness, 1.0, {{element.stiffness[k], 1}}, {}, matrix});
    }
    if (element.damping[k] != k_no_field) {
      result.pieces.push_back({ElementPiece::Kind::damping, 1.0, {{element.damping[k], 1}}, {}, matrix});
    }
  }
}

}  // namespace

const ElementTraits<BushElement> BushElement::k_traits = {
    .card = [](const BushElement& element) -> std::string_view { return element.card; },
    .nodes = nodes_of<BushElement>,
    .topology = line_topology<BushElement>,
    .add_pieces = add_bush};

}  // namespace mottle::fem
