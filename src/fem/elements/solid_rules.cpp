#include "fem/elements/solid_rules.hpp"

#include <cmath>
#include <utility>

namespace mottle::fem::solid_shapes {
namespace {

/// Three points with barycentric coordinates (1 - 2 a, a, a).
void add_triangle_orbit(Rule& rule, double weight, double a) {
  for (const auto& [x, y] : {std::pair{a, a}, {1.0 - 2.0 * a, a}, {a, 1.0 - 2.0 * a}})
    rule.push_back({weight, {x, y, 0}});
}

/// Four points with barycentric coordinates (1 - 3 a, a, a, a).
void add_tetrahedron_orbit(Rule& rule, double weight, double a) {
  rule.push_back({weight, {a, a, a}});
  for (int axis = 0; axis < 3; ++axis) {
    rule.push_back({weight, Eigen::Vector3d::Constant(a)});
    rule.back().position(axis) = 1.0 - 3.0 * a;
  }
}

}  // namespace

Rule gauss(int count) {
  if (count == 2) {
    const double far = 1.0 / std::sqrt(3.0);
    return {{1.0, {-far, 0, 0}}, {1.0, {far, 0, 0}}};
  }
  if (count == 3) {
    const double far = std::sqrt(0.6);
    return {{5.0 / 9.0, {-far, 0, 0}}, {8.0 / 9.0, {0, 0, 0}}, {5.0 / 9.0, {far, 0, 0}}};
  }
  const double spread = 2.0 / 7.0 * std::sqrt(1.2), less = std::sqrt(30.0) / 36.0;
  const double near = std::sqrt(3.0 / 7.0 - spread), far = std::sqrt(3.0 / 7.0 + spread);
  return {
      {0.5 - less, {-far, 0, 0}}, {0.5 + less, {-near, 0, 0}}, {0.5 + less, {near, 0, 0}}, {0.5 - less, {far, 0, 0}}};
}

Rule cube(const Rule& line) {
  Rule rule;
  for (const Abscissa& z : line) {
    for (const Abscissa& y : line) {
      for (const Abscissa& x : line) {
        rule.push_back({x.weight * y.weight * z.weight, {x.position.x(), y.position.x(), z.position.x()}});
      }
    }
  }
  return rule;
}

Rule triangle_of_degree_2() {
  Rule rule;
  add_triangle_orbit(rule, 1.0 / 6.0, 1.0 / 6.0);
  return rule;
}

Rule triangle_of_degree_4() {
  Rule rule;
  add_triangle_orbit(rule, 0.223381589678011465703 / 2.0, 0.445948490915964886319);
  add_triangle_orbit(rule, 0.109951743655321867638 / 2.0, 0.091576213509770743460);
  return rule;
}

Rule triangle_of_degree_5() {
  Rule rule = {{9.0 / 80.0, {1.0 / 3.0, 1.0 / 3.0, 0.0}}};
  const double root = std::sqrt(15.0);
  add_triangle_orbit(rule, (155.0 - root) / 2400.0, (6.0 - root) / 21.0);
  add_triangle_orbit(rule, (155.0 + root) / 2400.0, (6.0 + root) / 21.0);
  return rule;
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

Rule tetrahedron_of_degree_2() {
  Rule rule;
  add_tetrahedron_orbit(rule, 1.0 / 24.0, (5.0 - std::sqrt(5.0)) / 20.0);
  return rule;
}

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

Rule hexahedron_corners() {
  Rule corners;
  for (const double z : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) corners.insert(corners.end(), {{0.0, {-1, y, z}}, {0.0, {1, y, z}}});
  }
  return corners;
}

Rule wedge_corners() {
  Rule corners;
  for (const double z : {-1.0, 1.0})
    corners.insert(corners.end(), {{0.0, {0, 0, z}}, {0.0, {1, 0, z}}, {0.0, {0, 1, z}}});
  return corners;
}

Rule pyramid_corners() {
  Rule corners = {{0.0, {0, 0, 1}}};
  for (const double y : {-1.0, 1.0}) corners.insert(corners.end(), {{0.0, {-1, y, 0}}, {0.0, {1, y, 0}}});
  return corners;
}

Rule tetrahedron_corners() {
  return {{0.0, {0, 0, 0}}, {0.0, {1, 0, 0}}, {0.0, {0, 1, 0}}, {0.0, {0, 0, 1}}};
}

Eigen::Vector4d barycentric(const Eigen::Vector3d& position) {
  return {1.0 - position.sum(), position.x(), position.y(), position.z()};
}

Eigen::Matrix<double, 3, 4> barycentric_gradients() {
  return (Eigen::Matrix<double, 3, 4>() << -1, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1).finished();
}

Table make_table(int nodes, int modes, const Rule& stiffness, const Rule& mass, const Rule& corners,
                 const Eigen::Vector3d& centre, void (*evaluate)(const Eigen::Vector3d& position, SolidPoint& point)) {
  const auto tabulate = [&](const Rule& rule) {
    std::vector<SolidPoint> points;
    for (const Abscissa& at : rule) {
      SolidPoint& point = points.emplace_back(
          SolidPoint{at.weight, Eigen::VectorXd(nodes), Eigen::Matrix3Xd(3, nodes), Eigen::Matrix3Xd(3, modes)});
      evaluate(at.position, point);
    }
    return points;
  };
  return {tabulate(stiffness), tabulate(mass), tabulate(corners), tabulate({{0.0, centre}}).front()};
}

}  // namespace mottle::fem::solid_shapes
