#include "mottle/fem/elements/shear_panel.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "fem/elements/solid_rules.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Corners = Eigen::Matrix<double, 2, 4>;

/// The mean plane: across both diagonals.
struct Plane {
  Eigen::Matrix3d axes;  ///< rows: x, y, normal
  Corners corners;
  Eigen::Vector4d heights;
  double size;
};

Plane plane_of(const PanelNodes& nodes) {
  const Eigen::Vector3d rising = nodes.col(2) - nodes.col(0), falling = nodes.col(3) - nodes.col(1);
  const Eigen::Vector3d across = rising.cross(falling);
  Plane plane{.axes = {}, .corners = {}, .heights = {}, .size = rising.norm() + falling.norm()};
  require(across.norm() > 1e-12 * plane.size * plane.size && std::isfinite(plane.size),
          "shear panel: the nodes enclose no area, points around an area are needed");
  plane.axes.row(0) = rising.normalized();
  plane.axes.row(2) = across.normalized();
  plane.axes.row(1) = plane.axes.row(2).cross(plane.axes.row(0));
  const PanelNodes local = plane.axes * (nodes.colwise() - Eigen::Vector3d(nodes.rowwise().mean()));
  plane.corners = local.topRows<2>();
  plane.heights = local.row(2);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector2d next = plane.corners.col((i + 1) % 4) - plane.corners.col(i);
    const Eigen::Vector2d before = plane.corners.col((i + 3) % 4) - plane.corners.col(i);
    require(next.x() * before.y() - next.y() * before.x() > 1e-9 * next.norm() * before.norm(),
            "shear panel: the angle at node {} is 180 degrees or more, a convex outline is needed", i + 1);
  }
  return plane;
}

/// The membrane forces in equilibrium, in homogeneous coordinates so that parallel edges need no case of their own.
class Forces {
 public:
  explicit Forces(const Plane& plane) : size_(plane.size) {
    std::array<Eigen::Vector3d, 4> edges;
    for (Eigen::Index i = 0; i < 4; ++i) {
      edges[static_cast<std::size_t>(i)] = point(plane.corners.col(i)).cross(point(plane.corners.col((i + 1) % 4)));
    }
    p_ = edges[0].cross(edges[2]).normalized();
    q_ = edges[1].cross(edges[3]).normalized();
    line_ = p_.cross(q_);
    line_ /= line_.dot(point(Eigen::Vector2d::Zero()));
  }

  Eigen::Matrix2d at(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d x = place / size_;
    const Eigen::Vector2d a = p_.z() * x - p_.head<2>(), b = q_.z() * x - q_.head<2>();
    return (a * b.transpose() + b * a.transpose()) / std::pow(distance(place), 3);
  }

  /// From the line between the points where opposite edges meet, one at the centre.
  double distance(const Eigen::Vector2d& place) const { return line_.dot(point(place)); }

 private:
  Eigen::Vector3d point(const Eigen::Vector2d& place) const { return {place.x() / size_, place.y() / size_, 1.0}; }

  double size_;
  Eigen::Vector3d p_, q_, line_;  ///< where opposite edges meet, and the line between, one at the centre
};

/// Weights and places from -1 to 1: four times four, for forces that fall with the third power of a distance.
std::vector<std::pair<double, double>> parent_points() {
  constexpr int k_parts = 4;
  std::vector<std::pair<double, double>> points;
  for (int part = 0; part < k_parts; ++part) {
    for (const auto& [weight, place] : solid_shapes::gauss(4))
      points.emplace_back(weight / k_parts, (2.0 * part + 1.0 + place.x()) / k_parts - 1.0);
  }
  return points;
}

/// Energy of the forces, twice, at unit G t: E = 2 (1 + nu).
double flexibility(const Plane& plane, const Forces& forces, double poisson) {
  double sum = 0.0;
  for (const auto& [weight_b, b] : parent_points()) {
    for (const auto& [weight_a, a] : parent_points()) {
      const Eigen::Vector4d shape =
          0.25 * Eigen::Vector4d((1 - a) * (1 - b), (1 + a) * (1 - b), (1 + a) * (1 + b), (1 - a) * (1 + b));
      Eigen::Matrix<double, 4, 2> slopes;
      slopes << b - 1, a - 1, 1 - b, -1 - a, 1 + b, 1 + a, -1 - b, 1 - a;
      const double area = (0.25 * plane.corners * slopes).determinant() * weight_a * weight_b;
      const Eigen::Matrix2d tensions = forces.at(plane.corners * shape);
      sum += area * ((1.0 + poisson) * tensions.squaredNorm() - poisson * tensions.trace() * tensions.trace());
    }
  }
  return sum / (2.0 * (1.0 + poisson));
}

/// Forces of the edges on the nodes, in the plane: [2 x node].
Corners edge_forces(const Plane& plane, const Forces& forces) {
  Corners result = Corners::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Index j = (i + 1) % 4;
    const Eigen::Vector2d side = plane.corners.col(j) - plane.corners.col(i), outwards(side.y(), -side.x());
    // Along the edge the flow is one over the square of the distance: its mean is one over the product at the ends.
    const Eigen::Vector2d middle = 0.5 * (plane.corners.col(i) + plane.corners.col(j));
    const double ends = forces.distance(plane.corners.col(i)) * forces.distance(plane.corners.col(j));
    const Eigen::Vector2d force = std::pow(forces.distance(middle), 2) / ends * forces.at(middle) * outwards;
    for (const Eigen::Index end : {i, j}) result.col(end) += 0.5 * force;
  }
  return result;
}

/// Least normal forces that balance forces in the plane which act at these heights.
Eigen::Vector4d balancing(const Plane& plane, const Corners& in_plane) {
  Eigen::Matrix<double, 3, 4> resultant;  // force along the normal, moments about x and y
  resultant << Eigen::RowVector4d::Ones(), plane.corners.row(1), -plane.corners.row(0);
  const Eigen::Vector3d moments(0.0, -in_plane.row(1).dot(plane.heights), in_plane.row(0).dot(plane.heights));
  return -resultant.transpose() * (resultant * resultant.transpose()).inverse() * moments;
}

}  // namespace

PanelMatrix shear_panel_stiffness(const PanelNodes& nodes, double poisson) {
  require(-1.0 < poisson && poisson <= 0.5, "Poisson's ratio is {}, it must lie in (-1, 0.5]", poisson);
  const Plane plane = plane_of(nodes);
  const Forces forces(plane);
  const Corners in_plane = edge_forces(plane, forces);
  const Eigen::Vector4d normal = balancing(plane, in_plane);
  Eigen::Matrix<double, 12, 1> v;
  for (Eigen::Index n = 0; n < 4; ++n)
    v.segment<3>(3 * n) = plane.axes.transpose() * Eigen::Vector3d(in_plane(0, n), in_plane(1, n), normal(n));
  return v * v.transpose() / flexibility(plane, forces, poisson);
}

double shear_panel_area(const PanelNodes& nodes) {
  return 0.5 * Eigen::Vector3d(nodes.col(2) - nodes.col(0)).cross(Eigen::Vector3d(nodes.col(3) - nodes.col(1))).norm();
}

}  // namespace mottle::fem
