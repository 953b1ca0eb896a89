#include "fem/elements/shell_flat.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle::fem::shell {
namespace {

/// Shape functions and their derivatives [xi, eta] at a parent point.
void shape_at(int node_count, double xi, double eta, Eigen::Vector4d& shape, Eigen::Matrix<double, 2, 4>& derivative) {
  if (node_count == 3) {
    shape = {1.0 - xi - eta, xi, eta, 0.0};
    derivative << -1.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0;
    return;
  }
  constexpr std::array<double, 4> corner_xi = {-1.0, 1.0, 1.0, -1.0}, corner_eta = {-1.0, -1.0, 1.0, 1.0};
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double along_xi = 1.0 + corner_xi[i] * xi, along_eta = 1.0 + corner_eta[i] * eta;
    shape(i) = 0.25 * along_xi * along_eta;
    derivative(0, i) = 0.25 * corner_xi[i] * along_eta;
    derivative(1, i) = 0.25 * corner_eta[i] * along_xi;
  }
}

Point point_at(const Flat& flat, double xi, double eta, double weight) {
  Point point{.xi = xi, .eta = eta};
  Eigen::Matrix<double, 2, 4> derivative;
  shape_at(flat.node_count, xi, eta, point.shape, derivative);
  const Eigen::Matrix2d jacobian = derivative * flat.nodes.transpose();
  point.area = weight * jacobian.determinant();
  require(point.area > 0.0, "shell: the element turns inwards or encloses no area, a convex outline is needed");
  point.inverse = jacobian.inverse();
  point.gradient = point.inverse * derivative;
  return point;
}

/// Rows: x, y, normal. Of a quadrilateral, the normal is across both diagonals and x halves the angle between them, so
/// that nothing depends on the node counted first.
Eigen::Matrix3d axes_of(const ShellInput& input) {
  const auto& r = input.nodes;
  Eigen::Vector3d across, x;
  if (input.node_count == 3) {
    x = r.col(1) - r.col(0);
    across = x.cross(r.col(2) - r.col(0));
  } else {
    const Eigen::Vector3d rising = r.col(2) - r.col(0), falling = r.col(3) - r.col(1);
    across = rising.cross(falling);
    x = rising.normalized() - falling.normalized();
  }
  const double span = (r.leftCols(input.node_count).colwise() - r.col(0)).norm();
  require(across.norm() > 1e-12 * span * span && std::isfinite(span),
          "shell: the nodes enclose no area, points around an area are needed");
  Eigen::Matrix3d axes;
  axes.row(2) = across.normalized();
  axes.row(0) = x.normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes;
}

}  // namespace

Plane plane_of(const ShellInput& input) {
  require(input.node_count == 3 || input.node_count == 4, "shell: {} nodes, 3 or 4 are needed", input.node_count);
  Plane plane{.axes = axes_of(input)};
  const Eigen::Vector3d mean = input.nodes.leftCols(input.node_count).rowwise().mean();
  for (Eigen::Index i = 0; i < input.node_count; ++i) plane.nodes.col(i) = plane.axes * (input.nodes.col(i) - mean);
  return plane;
}

Flat flatten(const ShellInput& input) {
  const Plane plane = plane_of(input);
  const Eigen::Index n = input.node_count;
  Flat flat{.node_count = input.node_count, .axes = plane.axes, .nodes = plane.nodes.topRows<2>()};
  if (n == 4) flat.heights = plane.nodes.row(2);
  for (Eigen::Index i = 0; i < n; ++i) {
    Edge& edge = flat.edges[i];
    edge.first = i;
    edge.second = (i + 1) % n;
    const Eigen::Vector2d side = flat.nodes.col(edge.second) - flat.nodes.col(edge.first);
    edge.length = side.norm();
    require(edge.length > 0.0, "shell: nodes {} and {} of the element coincide", i + 1, edge.second + 1);
    edge.tangent = side / edge.length;
  }
  // Below this, heights are rounding errors of the coordinates.
  flat.is_warped = flat.heights.cwiseAbs().maxCoeff() > 1e-10 * flat.edges[0].length;
  if (n == 3) {
    flat.point_count = 3;
    flat.points[0] = point_at(flat, 0.5, 0.0, 1.0 / 6.0);
    flat.points[1] = point_at(flat, 0.5, 0.5, 1.0 / 6.0);
    flat.points[2] = point_at(flat, 0.0, 0.5, 1.0 / 6.0);
    flat.centre = point_at(flat, 1.0 / 3.0, 1.0 / 3.0, 0.5);
  } else {
    const double g = 1.0 / std::sqrt(3.0);
    flat.points[0] = point_at(flat, -g, -g, 1.0);
    flat.points[1] = point_at(flat, g, -g, 1.0);
    flat.points[2] = point_at(flat, g, g, 1.0);
    flat.points[3] = point_at(flat, -g, g, 1.0);
    flat.centre = point_at(flat, 0.0, 0.0, 4.0);
  }
  for (Eigen::Index i = 0; i < flat.point_count; ++i) flat.area += flat.points[i].area;
  return flat;
}

Eigen::Matrix3d plane_stress(double poisson) {
  require(-1.0 < poisson && poisson <= 0.5, "shell: Poisson's ratio {:g} is outside (-1, 0.5]", poisson);
  Eigen::Matrix3d elasticity;
  elasticity << 1.0, poisson, 0.0, poisson, 1.0, 0.0, 0.0, 0.0, 0.5 * (1.0 - poisson);
  return elasticity / (1.0 - poisson * poisson);
}

}  // namespace mottle::fem::shell
