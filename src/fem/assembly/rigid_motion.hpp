// Motion of a point of a rigid body.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::fem {

/// cross_matrix(v) w = v x w.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// Displacements and rotations along `axes` (columns) at the end of `arm` (rows), from the three displacements and
/// three rotations in basic axes at its start (columns).
inline Eigen::Matrix<double, 6, 6> rigid_motion(const Eigen::Matrix3d& axes, const Eigen::Vector3d& arm) {
  Eigen::Matrix<double, 6, 6> motion = Eigen::Matrix<double, 6, 6>::Zero();
  motion.topLeftCorner<3, 3>() = axes.transpose();
  motion.topRightCorner<3, 3>() = -axes.transpose() * cross_matrix(arm);
  motion.bottomRightCorner<3, 3>() = axes.transpose();
  return motion;
}

}  // namespace mottle::fem
