#include "mottle/fem/finite_element_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mottle::fem {
namespace {

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

/// Directions of radius, azimuth and axis at a point given in local rectangular coordinates.
Eigen::Matrix3d cylindrical_directions(const Eigen::Vector3d& local) {
  const double radius = std::hypot(local.x(), local.y());
  const double c = radius > 0.0 ? local.x() / radius : 1.0;
  const double s = radius > 0.0 ? local.y() / radius : 0.0;
  Eigen::Matrix3d directions;
  directions << c, -s, 0, s, c, 0, 0, 0, 1;
  return directions;
}

}  // namespace

Eigen::Vector3d CoordinateSystem::to_basic(const Eigen::Vector3d& local) const {
  Eigen::Vector3d point = local;
  if (kind == Kind::cylindrical) {
    const double azimuth = radians(local(1));
    point = {local(0) * std::cos(azimuth), local(0) * std::sin(azimuth), local(2)};
  } else if (kind == Kind::spherical) {
    const double polar = radians(local(1));
    const double azimuth = radians(local(2));
    point = local(0) *
            Eigen::Vector3d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
  }
  return origin + axes * point;
}

Eigen::Matrix3d CoordinateSystem::directions_at(const Eigen::Vector3d& position) const {
  if (kind == Kind::rectangular) return axes;
  const Eigen::Vector3d local = axes.transpose() * (position - origin);
  const Eigen::Matrix3d cylindrical = cylindrical_directions(local);
  if (kind == Kind::cylindrical) return axes * cylindrical;
  // Radius, polar angle from the z axis, azimuth: the meridian plane turned by the polar angle.
  const double radius = local.norm();
  const double c = radius > 0.0 ? local.z() / radius : 1.0;
  const double s = radius > 0.0 ? std::hypot(local.x(), local.y()) / radius : 0.0;
  Eigen::Matrix3d directions;
  directions.col(0) = s * cylindrical.col(0) + c * cylindrical.col(2);
  directions.col(1) = c * cylindrical.col(0) - s * cylindrical.col(2);
  directions.col(2) = cylindrical.col(1);
  return axes * directions;
}

int FiniteElementModel::find_node(int id) const {
  const auto found =
      std::lower_bound(nodes.begin(), nodes.end(), id, [](const Node& node, int wanted) { return node.id < wanted; });
  return found != nodes.end() && found->id == id ? static_cast<int>(found - nodes.begin()) : -1;
}

}  // namespace mottle::fem
