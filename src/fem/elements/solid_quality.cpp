#include "fem/elements/solid_quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace mottle::fem {
namespace {

using NodesRef = Eigen::Ref<const Eigen::Matrix3Xd>;
using Edges = std::span<const std::array<int, 2>>;

constexpr std::array<std::array<int, 2>, 12> k_hexahedron_edges = {
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}}};
constexpr std::array<std::array<int, 2>, 9> k_wedge_edges = {
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {5, 3}}};
constexpr std::array<std::array<int, 2>, 8> k_pyramid_edges = {
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};
constexpr std::array<std::array<int, 2>, 6> k_tetrahedron_edges = {{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

double double_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b - a).cross(c - a).norm();
}

struct Extent {
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
};

Extent edge_lengths(const NodesRef& nodes, Edges edges) {
  Extent extent;
  for (const auto& [from, to] : edges) {
    const double length = (nodes.col(to) - nodes.col(from)).norm();
    extent.smallest = std::min(extent.smallest, length);
    extent.largest = std::max(extent.largest, length);
  }
  return extent;
}

double hexahedron_aspect_ratio(const NodesRef& nodes) {
  const Extent extent = edge_lengths(nodes, k_hexahedron_edges);
  return extent.largest / extent.smallest;
}

double wedge_aspect_ratio(const NodesRef& nodes) {
  const Edges edges(k_wedge_edges);
  const double longest = edge_lengths(nodes, edges).largest;
  double smallest = edge_lengths(nodes, edges.subspan(3, 3)).smallest;
  for (const int face : {0, 3}) {
    const double base = edge_lengths(nodes, edges.subspan(face == 0 ? 0 : 6, 3)).largest;
    const double height = double_area(nodes.col(face), nodes.col(face + 1), nodes.col(face + 2)) / base;
    smallest = std::min(smallest, height / std::sqrt(0.75));
  }
  return longest / smallest;
}

double pyramid_aspect_ratio(const NodesRef& nodes) {
  const Eigen::Vector3d base = (nodes.col(2) - nodes.col(0)).cross(nodes.col(3) - nodes.col(1));
  const Eigen::Vector3d middle = nodes.leftCols<4>().rowwise().mean();
  const double height = std::abs(base.dot(nodes.col(4) - middle)) / base.norm();
  const Extent extent = edge_lengths(nodes, k_pyramid_edges);
  return extent.largest / std::min(extent.smallest, height * std::sqrt(2.0));
}

double tetrahedron_aspect_ratio(const NodesRef& nodes) {
  double largest_face = 0.0;
  for (int left_out = 0; left_out < 4; ++left_out) {
    const auto corner = [&](int i) { return Eigen::Vector3d(nodes.col((left_out + i) % 4)); };
    largest_face = std::max(largest_face, double_area(corner(1), corner(2), corner(3)));
  }
  const Eigen::Vector3d apex = nodes.col(3) - nodes.col(0);
  const double six_volumes = (nodes.col(1) - nodes.col(0)).cross(nodes.col(2) - nodes.col(0)).dot(apex);
  // 2/3: square of height over edge of the regular tetrahedron.
  const double height = std::abs(six_volumes) / largest_face / std::sqrt(2.0 / 3.0);
  return edge_lengths(nodes, k_tetrahedron_edges).largest / height;
}

}  // namespace

std::span<const std::array<int, 2>> solid_edges(SolidShape shape) {
  switch (shape) {
    case SolidShape::hexahedron8:
    case SolidShape::hexahedron20:
      return k_hexahedron_edges;
    case SolidShape::wedge6:
    case SolidShape::wedge15:
      return k_wedge_edges;
    case SolidShape::pyramid5:
    case SolidShape::pyramid13:
      return k_pyramid_edges;
    default:
      return k_tetrahedron_edges;
  }
}

SolidQuality solid_quality(SolidShape shape, const NodesRef& nodes) {
  SolidQuality quality{.jacobian_ratio = jacobian_ratio(shape, nodes)};
  switch (shape) {
    case SolidShape::hexahedron8:
    case SolidShape::hexahedron20:
      quality.aspect_ratio = hexahedron_aspect_ratio(nodes);
      break;
    case SolidShape::wedge6:
    case SolidShape::wedge15:
      quality.aspect_ratio = wedge_aspect_ratio(nodes);
      break;
    case SolidShape::pyramid5:
    case SolidShape::pyramid13:
      quality.aspect_ratio = pyramid_aspect_ratio(nodes);
      break;
    default:
      quality.aspect_ratio = tetrahedron_aspect_ratio(nodes);
  }
  return quality;
}

}  // namespace mottle::fem
