// Shape functions of the solids with mid-edge nodes: serendipity [Zienkiewicz2013], of the pyramid [Bedrosian1992]. A
// product of one function a direction is differentiated factor by factor.
#include "fem/elements/solid_rules.hpp"

namespace mottle::fem::solid_shapes {
namespace {

using Gradient = Eigen::Vector3d;

/// Signs of a hexahedron's corners, then of its mid-edge nodes, 0 along the edge.
constexpr int k_hexahedron[20][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1},
                                     {1, -1, 1},   {1, 1, 1},   {-1, 1, 1},  {0, -1, -1}, {1, 0, -1},
                                     {0, 1, -1},   {-1, 0, -1}, {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},
                                     {-1, 1, 0},   {0, -1, 1},  {1, 0, 1},   {0, 1, 1},   {-1, 0, 1}};

/// Corners (1 + a) (1 + b) (1 + c) (a + b + c - 2) / 8 with a = +-xi...; mid-edges (1 - xi^2) (1 + b) (1 + c) / 4.
void evaluate_quadratic_hexahedron(const Eigen::Vector3d& position, SolidPoint& point) {
  for (int node = 0; node < 20; ++node) {
    const Eigen::Vector3d sign(k_hexahedron[node][0], k_hexahedron[node][1], k_hexahedron[node][2]);
    Eigen::Vector3d factor = Eigen::Vector3d::Ones() + sign.cwiseProduct(position), slope = sign;
    for (int axis = 0; axis < 3; ++axis) {
      if (sign(axis) != 0.0) continue;
      factor(axis) = 1.0 - position(axis) * position(axis);
      slope(axis) = -2.0 * position(axis);
    }
    const Gradient gradient(slope.x() * factor.y() * factor.z(), factor.x() * slope.y() * factor.z(),
                            factor.x() * factor.y() * slope.z());
    if (node < 8) {
      const double last = sign.dot(position) - 2.0;
      point.values(node) = factor.prod() * last / 8.0;
      point.gradients.col(node) = (gradient * last + factor.prod() * sign) / 8.0;
    } else {
      point.values(node) = factor.prod() / 4.0;
      point.gradients.col(node) = gradient / 4.0;
    }
  }
}

/// With h = (1 +- zeta) / 2 and L = barycentric coordinates: corners L h (2 L - 1 - 2 (1 - h)), mid-edges 4 Li Lj h,
/// upright ones L (1 - zeta^2).
void evaluate_quadratic_wedge(const Eigen::Vector3d& position, SolidPoint& point) {
  const double zeta = position.z();
  const Eigen::Vector4d corner = barycentric({position.x(), position.y(), 0.0});
  const Eigen::Matrix<double, 3, 4> gradients = barycentric_gradients();
  const auto set = [&](int node, double value, const Eigen::Vector2d& in_plane, double upwards) {
    point.values(node) = value;
    point.gradients.col(node) = Gradient(in_plane.x(), in_plane.y(), upwards);
  };
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Eigen::Vector2d slope_i = gradients.block<2, 1>(0, i), slope_j = gradients.block<2, 1>(0, j);
    for (const int top : {0, 1}) {
      const double side = top == 0 ? -1.0 : 1.0, height = 0.5 * (1.0 + side * zeta), slope = 0.5 * side;
      set(i + 3 * top, corner(i) * height * (2.0 * corner(i) + 2.0 * height - 3.0),
          height * (4.0 * corner(i) + 2.0 * height - 3.0) * slope_i,
          corner(i) * slope * (2.0 * corner(i) + 4.0 * height - 3.0));
      set(6 + i + 6 * top, 4.0 * corner(i) * corner(j) * height,
          4.0 * height * (corner(i) * slope_j + corner(j) * slope_i), 4.0 * corner(i) * corner(j) * slope);
    }
    set(9 + i, corner(i) * (1.0 - zeta * zeta), (1.0 - zeta * zeta) * slope_i, -2.0 * zeta * corner(i));
  }
}

/// @param position  (a, b, zeta). With h = 1 - zeta, u = 1 +- a, v = 1 +- b: corners h u v (h (+-a +- b) - 1) / 4,
///                  apex zeta (2 zeta - 1), mid-edges of the base h^2 (1 - a^2) v / 2, upright ones zeta h u v
void evaluate_quadratic_pyramid(const Eigen::Vector3d& position, SolidPoint& point) {
  constexpr int k_signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const double a = position.x(), b = position.y(), zeta = position.z(), h = 1.0 - zeta;
  // Derivatives by a and b are given over h: those by xi and eta. At a fixed place the height moves a and b as well.
  const auto set = [&](int node, double value, double by_xi, double by_eta, double upwards) {
    point.values(node) = value;
    point.gradients.col(node) = Gradient(by_xi, by_eta, upwards + a * by_xi + b * by_eta);
  };
  for (int i = 0; i < 4; ++i) {
    const double s = k_signs[i][0], t = k_signs[i][1], u = 1.0 + s * a, v = 1.0 + t * b, sum = s * a + t * b;
    set(i, 0.25 * h * u * v * (h * sum - 1.0), 0.25 * s * v * (h * (sum + u) - 1.0),
        0.25 * t * u * (h * (sum + v) - 1.0), -0.25 * u * v * (2.0 * h * sum - 1.0));
    set(9 + i, zeta * h * u * v, zeta * s * v, zeta * t * u, (1.0 - 2.0 * zeta) * u * v);
  }
  for (const int side : {-1, 1}) {
    const double u = 1.0 + side * a, v = 1.0 + side * b, across_a = 1.0 - a * a, across_b = 1.0 - b * b;
    set(side < 0 ? 5 : 7, 0.5 * h * h * across_a * v, -h * a * v, 0.5 * h * across_a * side, -h * across_a * v);
    set(side < 0 ? 8 : 6, 0.5 * h * h * across_b * u, 0.5 * h * across_b * side, -h * b * u, -h * across_b * u);
  }
  set(4, zeta * (2.0 * zeta - 1.0), 0.0, 0.0, 4.0 * zeta - 1.0);
}

void evaluate_quadratic_tetrahedron(const Eigen::Vector3d& position, SolidPoint& point) {
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

}  // namespace

// Each rule integrates the forces of a constant stress exactly whatever the edges are, so that curved elements pass the
// patch test (of tetrahedra see stiffness_points), and mass and volume where edges are straight.
const Table& quadratic_hexahedron() {
  static const Table table = make_table(20, 0, cube(gauss(3)), cube(gauss(4)), hexahedron_corners(),
                                        Eigen::Vector3d::Zero(), evaluate_quadratic_hexahedron);
  return table;
}

const Table& quadratic_wedge() {
  static const Table table =
      make_table(15, 0, prism(triangle_of_degree_4(), gauss(3)), prism(triangle_of_degree_5(), gauss(4)),
                 wedge_corners(), Eigen::Vector3d(1.0 / 3.0, 1.0 / 3.0, 0.0), evaluate_quadratic_wedge);
  return table;
}

const Table& quadratic_pyramid() {
  static const Table table = make_table(13, 0, collapsed(gauss(4), gauss(4)), collapsed(gauss(4), gauss(4)),
                                        pyramid_corners(), Eigen::Vector3d(0.0, 0.0, 0.25), evaluate_quadratic_pyramid);
  return table;
}

const Table& quadratic_tetrahedron() {
  static const Table table =
      make_table(10, 0, tetrahedron_of_degree_2(), tetrahedron_of_degree_5(), tetrahedron_corners(),
                 Eigen::Vector3d::Constant(0.25), evaluate_quadratic_tetrahedron);
  return table;
}

}  // namespace mottle::fem::solid_shapes
