#include "fem/elements/solid_shapes.hpp"

#include <cmath>

namespace mottle::fem::solid_shapes {
namespace {

struct Abscissa {
  double weight;
  Eigen::Vector3d position;
};
using Rule = std::vector<Abscissa>;

Rule gauss(int count) {
  const double far = count == 2 ? 1.0 / std::sqrt(3.0) : std::sqrt(0.6);
  if (count == 2) return {{1.0, {-far, 0, 0}}, {1.0, {far, 0, 0}}};
  return {{5.0 / 9.0, {-far, 0, 0}}, {8.0 / 9.0, {0, 0, 0}}, {5.0 / 9.0, {far, 0, 0}}};
}

Rule cube(int count) {
  Rule rule;
  const Rule line = gauss(count);
  for (const Abscissa& z : line) {
    for (const Abscissa& y : line) {
      for (const Abscissa& x : line) {
        rule.push_back({x.weight * y.weight * z.weight, {x.position.x(), y.position.x(), z.position.x()}});
      }
    }
  }
  return rule;
}

/// Three points with barycentric coordinates (1 - 2 a, a, a).
void add_triangle_orbit(Rule& rule, double weight, double a) {
  for (const auto& [x, y] : {std::pair{a, a}, {1.0 - 2.0 * a, a}, {a, 1.0 - 2.0 * a}})
    rule.push_back({weight, {x, y, 0}});
}

Rule prism(const Rule& triangle, const Rule& line) {
  Rule rule;
  for (const Abscissa& z : line) {
    for (const Abscissa& xy : triangle) {
      rule.push_back({xy.weight * z.weight, {xy.position.x(), xy.position.y(), z.position.x()}});
    }
  }
  return rule;
}

/// Four points with barycentric coordinates (1 - 3 a, a, a, a).
void add_tetrahedron_orbit(Rule& rule, double weight, double a) {
  rule.push_back({weight, {a, a, a}});
  for (int axis = 0; axis < 3; ++axis) {
    rule.push_back({weight, Eigen::Vector3d::Constant(a)});
    rule.back().position(axis) = 1.0 - 3.0 * a;
  }
}

Rule tetrahedron_of_degree_2() {
  Rule rule;
  add_tetrahedron_orbit(rule, 1.0 / 24.0, (5.0 - std::sqrt(5.0)) / 20.0);
  return rule;
}

/// 14 points, all weights positive [Walkington2000].
Rule tetrahedron_of_degree_5() {
  Rule rule;
  add_tetrahedron_orbit(rule, 0.073493043116361949544 / 6.0, 0.092735250310891226402);
  add_tetrahedron_orbit(rule, 0.112687925718015850799 / 6.0, 0.310885919263300609797);
  const double a = 0.454496295874350350508, b = 0.5 - a;
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& [one, others] : {std::pair{a, b}, {b, a}}) {
      rule.push_back({0.042546020777081466438 / 6.0, Eigen::Vector3d::Constant(others)});
      rule.back().position(axis) = one;
    }
  }
  return rule;
}

/// Points of a pyramid as (a, b, zeta), a and b from -1 to 1 at every height: xi = a (1 - zeta), eta = b (1 - zeta).
/// The weights contain the section's area that this leaves.
Rule collapsed(const Rule& line, const Rule& height) {
  Rule rule;
  for (const Abscissa& z : height) {
    const double zeta = 0.5 * (1.0 + z.position.x());
    for (const Abscissa& y : line) {
      for (const Abscissa& x : line) {
        rule.push_back({0.5 * z.weight * (1.0 - zeta) * (1.0 - zeta) * x.weight * y.weight,
                        {x.position.x(), y.position.x(), zeta}});
      }
    }
  }
  return rule;
}

using Gradient = Eigen::Vector3d;

/// Barycentric coordinates of a triangle or tetrahedron whose first corner is the origin of the own coordinates.
Eigen::Vector4d barycentric(const Eigen::Vector3d& position) {
  return {1.0 - position.sum(), position.x(), position.y(), position.z()};
}

Eigen::Matrix<double, 3, 4> barycentric_gradients() {
  return (Eigen::Matrix<double, 3, 4>() << -1, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1).finished();
}

void evaluate(const Eigen::Vector3d& position, SolidPoint<8, 3>& point) {
  constexpr int k_signs[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                 {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  for (int node = 0; node < 8; ++node) {
    const Eigen::Vector3d sign(k_signs[node][0], k_signs[node][1], k_signs[node][2]);
    const Eigen::Vector3d factor = Eigen::Vector3d::Ones() + sign.cwiseProduct(position);
    point.values(node) = factor.prod() / 8.0;
    point.gradients.col(node) = Gradient(sign.x() * factor.y() * factor.z(), factor.x() * sign.y() * factor.z(),
                                         factor.x() * factor.y() * sign.z()) /
                                8.0;
  }
  point.mode_gradients = (-2.0 * position).asDiagonal();
}

void evaluate(const Eigen::Vector3d& position, SolidPoint<6, 4>& point) {
  const Eigen::Vector3d in_plane(position.x(), position.y(), 0.0);
  const Eigen::Vector4d corner = barycentric(in_plane);
  const Eigen::Matrix<double, 3, 4> gradients = barycentric_gradients();
  const auto slope = [&gradients](int i) { return Gradient(gradients(0, i), gradients(1, i), 0.0); };
  for (int node = 0; node < 6; ++node) {
    const int i = node % 3;
    const double sign = node < 3 ? -1.0 : 1.0, height = 0.5 * (1.0 + sign * position.z());
    point.values(node) = corner(i) * height;
    point.gradients.col(node) = slope(i) * height + Gradient(0.0, 0.0, 0.5 * sign * corner(i));
  }
  constexpr double k_mean = 1.0 / 3.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    point.mode_gradients.col(i) = (corner(i) - k_mean) * slope(j) + (corner(j) - k_mean) * slope(i);
  }
  point.mode_gradients.col(3) = Gradient(0.0, 0.0, -2.0 * position.z());
}

/// @param position  (a, b, zeta); the gradients with respect to xi, eta, zeta do not depend on the height
void evaluate(const Eigen::Vector3d& position, SolidPoint<5, 0>& point) {
  constexpr int k_signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int node = 0; node < 4; ++node) {
    const double s = k_signs[node][0], t = k_signs[node][1], a = s * position.x(), b = t * position.y();
    point.values(node) = 0.25 * (1.0 - position.z()) * (1.0 + a) * (1.0 + b);
    point.gradients.col(node) = 0.25 * Gradient(s * (1.0 + b), t * (1.0 + a), a * b - 1.0);
  }
  point.values(4) = position.z();
  point.gradients.col(4) = Gradient::UnitZ();
}

void evaluate(const Eigen::Vector3d& position, SolidPoint<4, 0>& point) {
  point.values = barycentric(position);
  point.gradients = barycentric_gradients();
}

void evaluate(const Eigen::Vector3d& position, SolidPoint<10, 0>& point) {
  constexpr int k_ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const Eigen::Vector4d corner = barycentric(position);
  const Eigen::Matrix<double, 3, 4> gradients = barycentric_gradients();
  for (int i = 0; i < 4; ++i) {
    point.values(i) = corner(i) * (2.0 * corner(i) - 1.0);
    point.gradients.col(i) = (4.0 * corner(i) - 1.0) * gradients.col(i);
  }
  for (int edge = 0; edge < 6; ++edge) {
    const int i = k_ends[edge][0], j = k_ends[edge][1];
    point.values(4 + edge) = 4.0 * corner(i) * corner(j);
    point.gradients.col(4 + edge) = 4.0 * (corner(i) * gradients.col(j) + corner(j) * gradients.col(i));
  }
}

template <int nodes, int modes>
typename Table<nodes, modes>::Points tabulate(const Rule& rule) {
  typename Table<nodes, modes>::Points points(rule.size());
  for (std::size_t i = 0; i < rule.size(); ++i) {
    points[i].weight = rule[i].weight;
    evaluate(rule[i].position, points[i]);
  }
  return points;
}

template <int nodes, int modes>
Table<nodes, modes> make_table(const Rule& stiffness, const Rule& mass, const Rule& corners,
                               const Eigen::Vector3d& centre) {
  return {tabulate<nodes, modes>(stiffness), tabulate<nodes, modes>(mass), tabulate<nodes, modes>(corners),
          tabulate<nodes, modes>({{0.0, centre}}).front()};
}

Rule tetrahedron_corners() {
  return {{0.0, {0, 0, 0}}, {0.0, {1, 0, 0}}, {0.0, {0, 1, 0}}, {0.0, {0, 0, 1}}};
}

}  // namespace

const HexahedronTable& hexahedron() {
  static const HexahedronTable table = [] {
    Rule corners;
    for (const double z : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) corners.insert(corners.end(), {{0.0, {-1, y, z}}, {0.0, {1, y, z}}});
    }
    // 3 points a direction: mass and determinant of a distorted element are of degree 4 in each coordinate.
    return make_table<8, 3>(cube(2), cube(3), corners, Eigen::Vector3d::Zero());
  }();
  return table;
}

const WedgeTable& wedge() {
  static const WedgeTable table = [] {
    Rule of_degree_2, of_degree_4, corners;
    add_triangle_orbit(of_degree_2, 1.0 / 6.0, 1.0 / 6.0);
    // [Dunavant1985], 6 points. Degree 3 is reached by the mass of a distorted wedge.
    add_triangle_orbit(of_degree_4, 0.223381589678011465703 / 2.0, 0.445948490915964886319);
    add_triangle_orbit(of_degree_4, 0.109951743655321867638 / 2.0, 0.091576213509770743460);
    for (const double z : {-1.0, 1.0})
      corners.insert(corners.end(), {{0.0, {0, 0, z}}, {0.0, {1, 0, z}}, {0.0, {0, 1, z}}});
    return make_table<6, 4>(prism(of_degree_2, gauss(2)), prism(of_degree_4, gauss(3)), corners,
                            Eigen::Vector3d(1.0 / 3.0, 1.0 / 3.0, 0.0));
  }();
  return table;
}

const PyramidTable& pyramid() {
  static const PyramidTable table = [] {
    Rule corners = {{0.0, {0, 0, 1}}};
    for (const double y : {-1.0, 1.0}) corners.insert(corners.end(), {{0.0, {-1, y, 0}}, {0.0, {1, y, 0}}});
    // Forces of a constant stress are of degree 2 in a and b, mass and determinant together of degree 4.
    return make_table<5, 0>(collapsed(gauss(2), gauss(2)), collapsed(gauss(3), gauss(3)), corners,
                            Eigen::Vector3d(0.0, 0.0, 0.25));
  }();
  return table;
}

const TetrahedronTable& tetrahedron() {
  static const Eigen::Vector3d centre = Eigen::Vector3d::Constant(0.25);
  static const TetrahedronTable table =
      make_table<4, 0>({{1.0 / 6.0, centre}}, tetrahedron_of_degree_2(), tetrahedron_corners(), centre);
  return table;
}

const QuadraticTetrahedronTable& quadratic_tetrahedron() {
  static const QuadraticTetrahedronTable table = make_table<10, 0>(
      tetrahedron_of_degree_2(), tetrahedron_of_degree_5(), tetrahedron_corners(), Eigen::Vector3d::Constant(0.25));
  return table;
}

}  // namespace mottle::fem::solid_shapes
