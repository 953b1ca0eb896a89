#include "fem/elements/curved_shell_tables.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "fem/elements/solid_rules.hpp"

namespace mottle::fem::curved_shell {
namespace {

void evaluate_quadrilateral(ParentPoint& point) {
  constexpr int k_signs[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  const double xi = point.xi, eta = point.eta;
  for (Eigen::Index n = 0; n < 8; ++n) {
    const double a = k_signs[n][0], b = k_signs[n][1], u = 1.0 + a * xi, v = 1.0 + b * eta, sum = a * xi + b * eta;
    if (n < 4) {
      point.values(n) = 0.25 * u * v * (sum - 1.0);
      point.slopes.col(n) << 0.25 * a * v * (sum + a * xi), 0.25 * b * u * (sum + b * eta);
    } else if (a == 0.0) {
      point.values(n) = 0.5 * (1.0 - xi * xi) * v;
      point.slopes.col(n) << -xi * v, 0.5 * b * (1.0 - xi * xi);
    } else {
      point.values(n) = 0.5 * (1.0 - eta * eta) * u;
      point.slopes.col(n) << 0.5 * a * (1.0 - eta * eta), -eta * u;
    }
  }
  point.bubble = (1.0 - xi * xi) * (1.0 - eta * eta);
  point.bubble_slopes << -2.0 * xi * (1.0 - eta * eta), -2.0 * eta * (1.0 - xi * xi);
}

void evaluate_triangle(ParentPoint& point) {
  const Eigen::Vector3d corner(1.0 - point.xi - point.eta, point.xi, point.eta);
  const Eigen::Matrix<double, 2, 3> gradients{{-1.0, 1.0, 0.0}, {-1.0, 0.0, 1.0}};
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index j = (i + 1) % 3;
    point.values(i) = corner(i) * (2.0 * corner(i) - 1.0);
    point.slopes.col(i) = (4.0 * corner(i) - 1.0) * gradients.col(i);
    point.values(3 + i) = 4.0 * corner(i) * corner(j);
    point.slopes.col(3 + i) = 4.0 * (corner(i) * gradients.col(j) + corner(j) * gradients.col(i));
  }
  point.bubble = 27.0 * corner.prod();
  point.bubble_slopes = 27.0 * (corner(1) * corner(2) * gradients.col(0) + corner(2) * corner(0) * gradients.col(1) +
                                corner(0) * corner(1) * gradients.col(2));
}

ParentPoint point_at(int node_count, double xi, double eta, double weight = 0.0) {
  ParentPoint point{.xi = xi, .eta = eta, .weight = weight};
  point.values.resize(node_count);
  point.slopes.resize(2, node_count);
  node_count == 8 ? evaluate_quadrilateral(point) : evaluate_triangle(point);
  return point;
}

std::vector<ParentPoint> square(int count) {
  std::vector<ParentPoint> points;
  const solid_shapes::Rule line = solid_shapes::gauss(count);
  for (const auto& y : line) {
    for (const auto& x : line) points.push_back(point_at(8, x.position.x(), y.position.x(), x.weight * y.weight));
  }
  return points;
}

/// Where Gauss puts two points on [0, 1].
const double k_near = 0.5 - 0.5 / std::sqrt(3.0);

/// The values at the ties and the means over the parent element of a covariant shear.
template <typename Shear>
Eigen::MatrixXd shear_samples(const Tables& tables, const Shear& shear) {
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(2, shear(tables.centre).cols());
  for (const ParentPoint& point : tables.points) means += point.weight * shear(point);
  Eigen::MatrixXd samples(std::ssize(tables.shear_ties) + 2, means.cols());
  Eigen::Index row = 0;
  for (const Tie& tie : tables.shear_ties) samples.row(row++) = tie.direction.transpose() * shear(tie.point);
  samples.bottomRows(2) = means;
  return samples;
}

void fit_shear(Tables& tables) {
  const auto functions = [&](const ParentPoint& point) {
    return shear_functions(tables.node_count, point.xi, point.eta);
  };
  tables.shear_fit = shear_samples(tables, functions).inverse();
}

Tables quadrilateral() {
  Tables tables{.node_count = 8, .nodes = {}, .points = square(3), .centre = point_at(8, 0.0, 0.0)};
  constexpr double k_places[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  for (const auto& [xi, eta] : k_places) tables.nodes.push_back(point_at(8, xi, eta));
  tables.reduced = square(2);
  for (const double at : {-1.0 / std::sqrt(3.0), 1.0 / std::sqrt(3.0)}) {
    for (const double side : {-1.0, 1.0}) {
      tables.shear_ties.push_back({point_at(8, at, side), Eigen::Vector2d::UnitX()});
      tables.shear_ties.push_back({point_at(8, side, at), Eigen::Vector2d::UnitY()});
    }
  }
  fit_shear(tables);
  return tables;
}

Tables triangle() {
  Tables tables{.node_count = 6, .nodes = {}, .points = {}, .centre = point_at(6, 1.0 / 3.0, 1.0 / 3.0)};
  constexpr double k_places[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  for (const auto& [xi, eta] : k_places) tables.nodes.push_back(point_at(6, xi, eta));
  for (const auto& [weight, place] : solid_shapes::triangle_of_degree_5())
    tables.points.push_back(point_at(6, place.x(), place.y(), weight));
  const double far = 1.0 - k_near, aside = 1.0 / std::sqrt(3.0);
  const Eigen::Vector2d x = Eigen::Vector2d::UnitX(), y = Eigen::Vector2d::UnitY();
  const auto tie = [](double xi, double eta, const Eigen::Vector2d& along) { return Tie{point_at(6, xi, eta), along}; };
  tables.shear_ties = {tie(k_near, 0.0, x), tie(far, 0.0, x),        tie(0.0, k_near, y),
                       tie(0.0, far, y),    tie(k_near, far, y - x), tie(far, k_near, y - x)};
  tables.membrane_ties = {tie(k_near, 0.0, x),     tie(far, 0.0, x),        tie(k_near, aside, x),
                          tie(0.0, k_near, y),     tie(0.0, far, y),        tie(aside, k_near, y),
                          tie(far, k_near, y - x), tie(k_near, far, y - x), tie(k_near, k_near, y - x)};
  fit_shear(tables);
  return tables;
}

}  // namespace

const Tables& tables(int node_count) {
  static const Tables of_eight = quadrilateral(), of_six = triangle();
  return node_count == 8 ? of_eight : of_six;
}

Eigen::MatrixXd shear_functions(int node_count, double xi, double eta) {
  if (node_count == 8) {
    Eigen::MatrixXd functions = Eigen::MatrixXd::Zero(2, 10);
    functions.row(0).head<5>() << 1.0, xi, eta, xi * eta, eta * eta;
    functions.row(1).tail<5>() << 1.0, xi, eta, xi * eta, xi * xi;
    return functions;
  }
  Eigen::MatrixXd functions = Eigen::MatrixXd::Zero(2, 8);
  functions.row(0) << 1.0, xi, eta, 0.0, 0.0, 0.0, xi * eta, eta * eta;
  functions.row(1) << 0.0, 0.0, 0.0, 1.0, xi, eta, -xi * xi, -xi * eta;
  return functions;
}

Eigen::RowVectorXd extrapolation(const Tables& tables, double xi, double eta) {
  Eigen::RowVectorXd weights(std::ssize(tables.reduced));
  Eigen::Index next = 0;
  for (const ParentPoint& point : tables.reduced)
    weights(next++) = 0.25 * (1.0 + 3.0 * xi * point.xi) * (1.0 + 3.0 * eta * point.eta);
  return weights;
}

Eigen::RowVector3d linear_fit(const Tables& tables, int direction, double xi, double eta) {
  Eigen::Matrix3d at_ties;
  for (int row = 0; row < 3; ++row) {
    const ParentPoint& point = tables.membrane_ties[static_cast<std::size_t>(3 * direction + row)].point;
    at_ties.row(row) << 1.0, point.xi, point.eta;
  }
  return Eigen::RowVector3d(1.0, xi, eta) * at_ties.inverse();
}

}  // namespace mottle::fem::curved_shell
