// Bending and transverse shear of plates. Rotations vary linearly between the nodes, plus a quadratic part along each
// edge by which a fraction of the edge's shear becomes bending [Katili1993]; the remaining shear is tied at the edges
// [Bathe1985]. Fraction 0 is MITC4 (of three nodes MITC3, which locks), fraction 1 the Kirchhoff plates DKQ and DKT.
#include "fem/elements/shell_flat.hpp"

namespace mottle::fem::shell {
namespace {

using Row12 = Eigen::Matrix<double, 1, 12>;

/// d / d (x, y) of the edge's bubble, one at its middle and zero on the other edges.
Eigen::Vector2d bubble_gradient(const Flat& flat, const Point& point, Eigen::Index edge) {
  if (flat.node_count == 3) {
    const Eigen::Index j = (edge + 1) % 3;
    return 4.0 * (point.shape(edge) * point.gradient.col(j) + point.shape(j) * point.gradient.col(edge));
  }
  const double xi = point.xi, eta = point.eta;
  Eigen::Vector2d parent;
  if (edge % 2 == 0) {
    const double side = edge == 0 ? -1.0 : 1.0;
    parent << -xi * (1.0 + side * eta), 0.5 * side * (1.0 - xi * xi);
  } else {
    const double side = edge == 1 ? 1.0 : -1.0;
    parent << 0.5 * side * (1.0 - eta * eta), -eta * (1.0 + side * xi);
  }
  return point.inverse * parent;
}

/// Mean shear along an edge of linear rotations, times its length: the fall of w plus what the rotations turn.
Row12 edge_gap(const Edge& edge) {
  Row12 gap = Row12::Zero();
  gap(3 * edge.first) = -1.0;
  gap(3 * edge.second) = 1.0;
  for (const Eigen::Index node : {edge.first, edge.second}) {
    // Slopes beta_x = rotation about y, beta_y = -rotation about x.
    gap(3 * node + 1) = -0.5 * edge.length * edge.tangent.y();
    gap(3 * node + 2) = 0.5 * edge.length * edge.tangent.x();
  }
  return gap;
}

using EdgeGaps = Eigen::Matrix<double, 4, 12>;

/// Curvatures xx, yy, xy. @param followed  bubble's slope along each edge by the gaps
Eigen::Matrix<double, 3, 12> curvature_at(const Flat& flat, const Point& point, const EdgeGaps& followed) {
  Eigen::Matrix<double, 3, 12> curvature = Eigen::Matrix<double, 3, 12>::Zero();
  for (Eigen::Index i = 0; i < flat.node_count; ++i) {
    const Eigen::Vector2d g = point.gradient.col(i);
    curvature.middleCols<2>(3 * i + 1) << 0.0, g.x(), -g.y(), 0.0, -g.x(), g.y();
  }
  for (Eigen::Index e = 0; e < flat.node_count; ++e) {
    const Eigen::Vector2d g = bubble_gradient(flat, point, e);
    const Eigen::Vector2d& t = flat.edges[e].tangent;
    const Eigen::Vector3d bubble(g.x() * t.x(), g.y() * t.y(), g.y() * t.x() + g.x() * t.y());
    curvature.noalias() += bubble * followed.row(e);
  }
  return curvature;
}

/// Transverse shears xz, yz that have the given mean along each edge (times the edge's length).
Eigen::Matrix<double, 2, 12> shear_at(const Flat& flat, const Point& point, const EdgeGaps& gaps) {
  Eigen::Matrix<double, 2, 12> parent;
  if (flat.node_count == 3) {
    const Row12 along_xi = gaps.row(0), along_eta = -gaps.row(2), excess = along_eta - along_xi - gaps.row(1);
    parent.row(0) = along_xi + point.eta * excess;
    parent.row(1) = along_eta - point.xi * excess;
  } else {
    parent.row(0) = 0.25 * ((1.0 - point.eta) * gaps.row(0) - (1.0 + point.eta) * gaps.row(2));
    parent.row(1) = 0.25 * ((1.0 + point.xi) * gaps.row(1) - (1.0 - point.xi) * gaps.row(3));
  }
  return point.inverse * parent;
}

}  // namespace

PlateStrains plate_strains(const Flat& flat, const std::array<double, 4>& fractions) {
  EdgeGaps followed = EdgeGaps::Zero(), remaining = EdgeGaps::Zero();
  for (Eigen::Index e = 0; e < flat.node_count; ++e) {
    const double fraction = fractions[static_cast<std::size_t>(e)];
    const Row12 gap = edge_gap(flat.edges[e]);
    followed.row(e) = -1.5 * fraction / flat.edges[e].length * gap;
    remaining.row(e) = (1.0 - fraction) * gap;
  }
  PlateStrains strains;
  for (Eigen::Index p = 0; p < flat.point_count; ++p) {
    strains.curvature[p] = curvature_at(flat, flat.points[p], followed);
    strains.shear[p] = shear_at(flat, flat.points[p], remaining);
  }
  return strains;
}

}  // namespace mottle::fem::shell
