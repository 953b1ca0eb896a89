#include "mottle/fem/elements/shell.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fem/elements/shell_flat.hpp"
#include "fem/elements/shell_motion.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using shell::Flat;
using shell::Point;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

/// Angle between two directions in degrees, 0 to 180.
double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), a.dot(b)));
}

double min_skew_angle(const ShellInput& input) {
  const auto& r = input.nodes;
  if (input.node_count == 4) {
    const Eigen::Vector3d along = r.col(1) + r.col(2) - r.col(0) - r.col(3);
    const Eigen::Vector3d across = r.col(2) + r.col(3) - r.col(0) - r.col(1);
    const double between = angle(along, across);
    return std::min(between, 180.0 - between);
  }
  double smallest = 180.0;
  for (Eigen::Index i = 0; i < 3; ++i)
    smallest = std::min(smallest, angle(r.col((i + 1) % 3) - r.col(i), r.col((i + 2) % 3) - r.col(i)));
  return smallest;
}

}  // namespace

ShellPieces shell_stiffness(const ShellInput& input) {
  require(input.shear_flexibility >= 0.0, "shell: a shear flexibility of {:g}, a number >= 0 is needed",
          input.shear_flexibility);
  ShellSection section{.membrane = shell::plane_stress(input.poisson_membrane),
                       .bending = shell::plane_stress(input.poisson_bending) / 12.0};
  if (input.shear_flexibility > 0.0) {
    section.shear.setIdentity();
    section.bending_over_shear = input.shear_flexibility / section.bending(0, 0);
  }
  return shell_stiffness(input, section);
}

ShellPieces shell_stiffness(const ShellInput& input, const ShellSection& section) {
  const Flat flat = shell::flatten(input);
  const shell::Motion motion = shell::motion_of(flat, input.offset);
  const auto local = shell::section_stiffness(flat, shell::in_element_axes(flat, input, section));
  return {.membrane = shell::to_basic(flat, motion, motion.in_plane, local.membrane),
          .bending = shell::to_basic(flat, motion, motion.out_of_plane, local.bending),
          .shear = shell::to_basic(flat, motion, motion.out_of_plane, local.shear),
          .drilling = shell::to_basic(flat, motion, motion.in_plane, shell::drilling(flat))};
}

LaminatePieces laminate_stiffness(const ShellInput& input, const ShellSection& section) {
  const Flat flat = shell::flatten(input);
  const shell::Motion motion = shell::motion_of(flat, input.offset);
  const auto local = shell::section_stiffness(flat, shell::in_element_axes(flat, input, section));
  LaminatePieces pieces;
  pieces.section = shell::to_basic(flat, motion, motion.in_plane, local.membrane) +
                   shell::to_basic(flat, motion, motion.out_of_plane, local.bending + local.shear);
  if (!section.coupling.isZero(0.0)) pieces.section += shell::coupling_to_basic(motion, local.coupling);
  pieces.drilling = shell::to_basic(flat, motion, motion.in_plane, shell::drilling(flat));
  return pieces;
}

ShellMatrix shell_mass(const ShellInput& input, MassKind kind) {
  const Flat flat = shell::flatten(input);
  Eigen::Matrix4d shares = Eigen::Matrix4d::Zero();
  for (Eigen::Index p = 0; p < flat.point_count; ++p) {
    const Point& point = flat.points[p];
    shares += point.area * point.shape * point.shape.transpose();
  }
  if (kind == MassKind::lumped) shares = Eigen::Vector4d(shares.rowwise().sum()).asDiagonal();
  // Displacement + rotation x (offset normal), by node.
  const Eigen::Vector3d arm = input.offset * flat.axes.row(2).transpose();
  Eigen::Matrix<double, 3, 6> motion = Eigen::Matrix<double, 3, 6>::Identity();
  motion.rightCols<3>() << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  const Eigen::Matrix<double, 6, 6> unit = motion.transpose() * motion;
  ShellMatrix mass = ShellMatrix::Zero();
  for (Eigen::Index i = 0; i < flat.node_count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) mass.block<6, 6>(6 * i, 6 * j) = shares(i, j) * unit;
  }
  return shell::symmetric(mass);
}

double shell_area(const ShellInput& input) {
  return shell::flatten(input).area;
}

ShellQuality shell_quality(const ShellInput& input) {
  const shell::Plane plane = shell::plane_of(input);
  const Eigen::Index n = input.node_count;
  ShellQuality quality{.skew = min_skew_angle(input)};
  double longest = 0.0, shortest = std::numeric_limits<double>::infinity();
  Eigen::Vector4d corner_areas = Eigen::Vector4d::Ones();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d next = plane.nodes.col((i + 1) % n) - plane.nodes.col(i);
    const Eigen::Vector3d before = plane.nodes.col((i + n - 1) % n) - plane.nodes.col(i);
    longest = std::max(longest, next.norm());
    shortest = std::min(shortest, next.norm());
    corner_areas(i) = next.x() * before.y() - next.y() * before.x();
  }
  quality.aspect = longest / shortest;
  if (n == 4) {
    const double half_diagonals =
        0.25 * ((input.nodes.col(2) - input.nodes.col(0)).norm() + (input.nodes.col(3) - input.nodes.col(1)).norm());
    quality.warp = plane.nodes.row(2).cwiseAbs().maxCoeff() / half_diagonals;
    quality.jacobian_ratio = corner_areas.minCoeff() / corner_areas.maxCoeff();
  }
  return quality;
}

}  // namespace mottle::fem
