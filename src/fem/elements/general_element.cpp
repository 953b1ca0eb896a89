#include "mottle/fem/elements/general_element.hpp"

#include <Eigen/LU>

#include "fem/assembly/constraint_equations.hpp"
#include "fem/assembly/rigid_motion.hpp"
#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

/// Its degrees of freedom `first`... under six rigid motions about `origin` [degree of freedom x 6]. Rotations are
/// scaled by 1 / `length`, so that what they do does not depend on the unit of length.
Eigen::MatrixXd rigid_motions(const FiniteElementModel& model, const GeneralElement& element, Eigen::Index first,
                              Eigen::Index count, const Eigen::Vector3d& origin, double length) {
  Eigen::MatrixXd motions(count, 6);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(first + k);
    const int node = element.nodes[at];
    const Eigen::Vector3d arm = model.nodes[static_cast<std::size_t>(node)].position - origin;
    motions.row(k) = rigid_motion(displacement_directions(model, node), arm).row(element.components[at]);
  }
  motions.rightCols<3>() /= length;
  return motions;
}

/// S by the rigid motion that the six u_d give.
Eigen::MatrixXd rigid_motion_by_positions(const FiniteElementModel& model, const GeneralElement& element) {
  const Eigen::Index independent = element.stiffness.rows();
  const auto total = static_cast<Eigen::Index>(element.nodes.size());
  const Eigen::Matrix3Xd points = positions(model, element.nodes);
  const Eigen::Vector3d origin = points.col(independent);
  const double size = (points.colwise() - origin).colwise().norm().maxCoeff();
  const double length = size > 0.0 ? size : 1.0;
  const Eigen::Matrix<double, 6, 6> of_six =
      rigid_motions(model, element, independent, total - independent, origin, length);
  Eigen::FullPivLU<Eigen::Matrix<double, 6, 6>> inverse(of_six);
  inverse.setThreshold(1e-10);
  require(inverse.isInvertible(),
          "its six UD do not determine a rigid-body motion; choose others, or give the matrix S");
  return rigid_motions(model, element, 0, independent, origin, length) * inverse.inverse();
}

void add_general(const FiniteElementModel& model, const GeneralElement& element, PieceSelection selection,
                 ElementPieces& result) {
  if (selection == PieceSelection::mass) return;
  result.is_basic = false;
  for (std::size_t k = 0; k < element.nodes.size(); ++k) {
    result.degrees_of_freedom.push_back(degree_of_freedom(element.nodes[k], element.components[k]));
  }
  const Eigen::Index independent = element.stiffness.rows();
  const auto total = static_cast<Eigen::Index>(element.nodes.size());
  Eigen::MatrixXd difference(independent, total);  // u_i - S u_d
  difference.leftCols(independent).setIdentity();
  if (total > independent) {
    const bool is_given = element.rigid_motion.size() > 0;
    difference.rightCols(total - independent) =
        -(is_given ? element.rigid_motion : rigid_motion_by_positions(model, element));
  }
  const Eigen::MatrixXd matrix = difference.transpose() * element.stiffness * difference;
  result.pieces.push_back({ElementPiece::Kind::stiffness, 1.0, {}, {}, 0.5 * (matrix + matrix.transpose())});
}

const Topology& unseen(const GeneralElement&) {
  static const Topology k_unseen;
  return k_unseen;
}

}  // namespace

const ElementTraits<GeneralElement> GeneralElement::k_traits = {
    .card = [](const GeneralElement&) -> std::string_view { return "GENEL"; },
    .nodes = nodes_of<GeneralElement>,
    .topology = unseen,
    .add_pieces = add_general};

}  // namespace mottle::fem
