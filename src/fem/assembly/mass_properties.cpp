#include "mottle/fem/assembly/mass_properties.hpp"

#include <cmath>

#include "fem/assembly/constraint_equations.hpp"
#include "fem/assembly/rigid_motion.hpp"
#include "fem/elements/element_pieces.hpp"

namespace mottle::fem {
namespace {

/// Motion of one degree of freedom for the six unit motions about `origin`.
Eigen::Matrix<double, 1, 6> rigid_row(const FiniteElementModel& model, int slot, bool is_basic,
                                      const Eigen::Vector3d& origin) {
  const int node = slot / 6;
  const int component = slot % 6;
  const Node& point = model.nodes[static_cast<std::size_t>(node)];
  Eigen::Matrix<double, 1, 6> row = Eigen::Matrix<double, 1, 6>::Zero();
  if (point.is_scalar) return row;  // has no position and no direction
  const Eigen::Matrix3d axes = is_basic ? Eigen::Matrix3d::Identity() : displacement_directions(model, node);
  const Eigen::RowVector3d direction = axes.col(component % 3).transpose();
  if (component >= 3) {
    row.tail<3>() = direction;
  } else {
    row.head<3>() = direction;
    row.tail<3>() = -direction * cross_matrix(point.position - origin);
  }
  return row;
}

}  // namespace

MassProperties mass_properties(const FiniteElementModel& model) {
  const int reference = model.settings.reference_node;
  const Eigen::Vector3d origin =
      reference < 0 ? Eigen::Vector3d(0, 0, 0) : model.nodes[static_cast<std::size_t>(reference)].position;
  MassProperties result;
  visit_elements(model, PieceSelection::mass, [&](ElementPieces& element) {
    const auto size = static_cast<Eigen::Index>(element.degrees_of_freedom.size());
    Eigen::MatrixXd motion(size, 6);
    for (Eigen::Index k = 0; k < size; ++k) {
      motion.row(k) =
          rigid_row(model, element.degrees_of_freedom[static_cast<std::size_t>(k)], element.is_basic, origin);
    }
    for (const ElementPiece& piece : element.pieces) {
      double coefficient = piece.factor / model.settings.mass_factor;
      for (const FieldPower& factor : piece.coefficient)
        coefficient *= std::pow(model.value(factor.field), factor.power);
      result.rigid_body += coefficient * motion.transpose() * piece.matrix * motion;
    }
  });
  result.mass = result.rigid_body.diagonal().head<3>();
  // First moments stand in the coupling block, [0 mx z -mx y; -my z 0 my x; mz y -mz x 0]; each is there twice.
  const auto& m = result.rigid_body;
  const auto mean = [&](double one, double other, int i, int k) {
    const double weight = result.mass(i) + result.mass(k);
    return weight > 0.0 ? (one - other) / weight : 0.0;
  };
  result.center = {mean(m(1, 5), m(2, 4), 1, 2), mean(m(2, 3), m(0, 5), 2, 0), mean(m(0, 4), m(1, 3), 0, 1)};
  Eigen::Matrix<double, 6, 3> turn;  // motion of the reference point by rotations about the centre
  turn << cross_matrix(result.center), Eigen::Matrix3d::Identity();
  result.inertia = turn.transpose() * m * turn;
  if (result.mass.maxCoeff() > 0.0) result.center += origin;
  return result;
}

}  // namespace mottle::fem
