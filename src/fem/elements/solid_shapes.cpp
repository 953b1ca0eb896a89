#include "fem/elements/solid_shapes.hpp"

#include "fem/elements/solid_rules.hpp"

namespace mottle::fem::solid_shapes {
namespace {

using Gradient = Eigen::Vector3d;

void evaluate_hexahedron(const Eigen::Vector3d& position, SolidPoint& point) {
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
  point.mode_gradients = Eigen::Matrix3d((-2.0 * position).asDiagonal());
}

void evaluate_wedge(const Eigen::Vector3d& position, SolidPoint& point) {
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
void evaluate_pyramid(const Eigen::Vector3d& position, SolidPoint& point) {
  constexpr int k_signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int node = 0; node < 4; ++node) {
    const double s = k_signs[node][0], t = k_signs[node][1], a = s * position.x(), b = t * position.y();
    point.values(node) = 0.25 * (1.0 - position.z()) * (1.0 + a) * (1.0 + b);
    point.gradients.col(node) = 0.25 * Gradient(s * (1.0 + b), t * (1.0 + a), a * b - 1.0);
  }
  point.values(4) = position.z();
  point.gradients.col(4) = Gradient::UnitZ();
}

void evaluate_tetrahedron(const Eigen::Vector3d& position, SolidPoint& point) {
  point.values = barycentric(position);
  point.gradients = barycentric_gradients();
}

}  // namespace

const Table& hexahedron() {
  static const Table table = [] {
    // 3 points a direction: mass and determinant of a distorted element are of degree 4 in each coordinate.
    return make_table(8, 3, cube(gauss(2)), cube(gauss(3)), hexahedron_corners(), Eigen::Vector3d::Zero(),
                      evaluate_hexahedron);
  }();
  return table;
}

const Table& wedge() {
  static const Table table = [] {
    // Degree 3 is reached by the mass of a distorted wedge.
    return make_table(6, 4, prism(triangle_of_degree_2(), gauss(2)), prism(triangle_of_degree_4(), gauss(3)),
                      wedge_corners(), Eigen::Vector3d(1.0 / 3.0, 1.0 / 3.0, 0.0), evaluate_wedge);
  }();
  return table;
}

const Table& pyramid() {
  static const Table table = [] {
    // Forces of a constant stress are of degree 2 in a and b, mass and determinant together of degree 4.
    return make_table(5, 0, collapsed(gauss(2), gauss(2)), collapsed(gauss(3), gauss(3)), pyramid_corners(),
                      Eigen::Vector3d(0.0, 0.0, 0.25), evaluate_pyramid);
  }();
  return table;
}

const Table& tetrahedron() {
  static const Eigen::Vector3d centre = Eigen::Vector3d::Constant(0.25);
  static const Table table = make_table(4, 0, {{1.0 / 6.0, centre}}, tetrahedron_of_degree_2(), tetrahedron_corners(),
                                        centre, evaluate_tetrahedron);
  return table;
}

const Table& table_of(SolidShape shape) {
  switch (shape) {
    case SolidShape::hexahedron8:
      return hexahedron();
    case SolidShape::wedge6:
      return wedge();
    case SolidShape::pyramid5:
      return pyramid();
    case SolidShape::tetrahedron4:
      return tetrahedron();
    case SolidShape::hexahedron20:
      return quadratic_hexahedron();
    case SolidShape::wedge15:
      return quadratic_wedge();
    case SolidShape::pyramid13:
      return quadratic_pyramid();
    case SolidShape::tetrahedron10:
      break;
  }
  return quadratic_tetrahedron();
}

}  // namespace mottle::fem::solid_shapes
