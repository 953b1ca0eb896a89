#include "fem/elements/shell_motion.hpp"

#include <Eigen/Geometry>

namespace mottle::fem::shell {
namespace {

using Rotation = Eigen::Matrix<double, 3, 24>;

/// Rotation of the element as a whole, in element axes, by the displacements of its nodes.
Rotation mean_rotation(const Flat& flat) {
  Rotation rotation = Rotation::Zero();
  for (Eigen::Index i = 0; i < flat.node_count; ++i) {
    const Eigen::Vector2d g = flat.centre.gradient.col(i);
    rotation.block<1, 3>(0, 6 * i) = g.y() * flat.axes.row(2);
    rotation.block<1, 3>(1, 6 * i) = -g.x() * flat.axes.row(2);
    rotation.block<1, 3>(2, 6 * i) = 0.5 * (g.x() * flat.axes.row(1) - g.y() * flat.axes.row(0));
  }
  return rotation;
}

/// Normal of a quadrilateral at a corner, in element axes.
Eigen::Vector3d corner_normal(const Flat& flat, Eigen::Index corner) {
  const auto from_corner = [&](Eigen::Index other) {
    const Eigen::Vector2d side = flat.nodes.col(other) - flat.nodes.col(corner);
    return Eigen::Vector3d(side.x(), side.y(), flat.heights(other) - flat.heights(corner));
  };
  return from_corner((corner + 1) % 4).cross(from_corner((corner + 3) % 4)).normalized();
}

}  // namespace

Motion motion_of(const Flat& flat, double offset) {
  Motion motion{.is_by_node = !flat.is_warped};
  const Rotation mean = flat.is_warped ? mean_rotation(flat) : Rotation::Zero();
  for (Eigen::Index i = 0; i < flat.node_count; ++i) {
    Rotation rotation = Rotation::Zero();
    rotation.block<3, 3>(0, 6 * i + 3) = flat.axes;
    double lever = offset;
    motion.in_plane.row(3 * i + 2) = rotation.row(2);
    if (flat.is_warped) {
      // The neighbours share the corner's normal, not the element's: about it they have no stiffness against a moment.
      const Eigen::Vector3d normal = corner_normal(flat, i);
      const Rotation lag = mean - rotation;
      rotation += normal * (normal.transpose() * lag);
      lever -= flat.heights(i);
    }
    motion.in_plane.row(3 * i) = lever * rotation.row(1);
    motion.in_plane.row(3 * i + 1) = -lever * rotation.row(0);
    motion.in_plane.block<2, 3>(3 * i, 6 * i) += flat.axes.topRows<2>();
    motion.out_of_plane.block<1, 3>(3 * i, 6 * i) = flat.axes.row(2);
    motion.out_of_plane.middleRows<2>(3 * i + 1) = rotation.topRows<2>();
  }
  return motion;
}

ShellMatrix to_basic(const Flat& flat, const Motion& motion, const MotionMatrix& corners,
                     const Eigen::Matrix<double, 12, 12>& local) {
  if (!motion.is_by_node) {
    const MotionMatrix forces = local * corners;
    ShellMatrix basic;
    basic.noalias() = corners.transpose() * forces;
    return symmetric(basic);
  }
  ShellMatrix basic = ShellMatrix::Zero();
  for (Eigen::Index i = 0; i < flat.node_count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Eigen::Matrix<double, 3, 6> forces = local.block<3, 3>(3 * i, 3 * j) * corners.block<3, 6>(3 * j, 6 * j);
      basic.block<6, 6>(6 * i, 6 * j).noalias() = corners.block<3, 6>(3 * i, 6 * i).transpose() * forces;
    }
  }
  return symmetric(basic);
}

ShellMatrix coupling_to_basic(const Motion& motion, const Eigen::Matrix<double, 12, 12>& local) {
  const MotionMatrix forces = local * motion.out_of_plane;
  ShellMatrix basic;
  basic.noalias() = motion.in_plane.transpose() * forces;
  return symmetric(basic + basic.transpose());
}

ShellMatrix symmetric(ShellMatrix matrix) {
  matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
  return matrix;
}

}  // namespace mottle::fem::shell
