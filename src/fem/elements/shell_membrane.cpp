// Membranes: the quadrilateral with incompatible modes [Taylor1976], the triangle of constant strain, and the weak
// resistance of the rotation about the normal, which neither has. A triangle that uses this rotation [Felippa2003] is
// far better in its plane but locks where thin shells are curved in two directions (8 % of the deflection of a coarse
// hemisphere) and stiffens where decks hold that rotation (PS = 6), so it is not used.
#include "fem/elements/shell_flat.hpp"

namespace mottle::fem::shell {
namespace {

using Strain2 = Eigen::Matrix<double, 3, 2>;

/// Strains xx, yy, xy of a displacement (u, v) times a function with this gradient.
Strain2 strain_of(const Eigen::Vector2d& gradient) {
  return (Strain2() << gradient.x(), 0.0, 0.0, gradient.y(), gradient.y(), gradient.x()).finished();
}

}  // namespace

MembraneStrains membrane_strains(const Flat& flat) {
  MembraneStrains strains;
  for (Eigen::Index p = 0; p < flat.point_count; ++p) {
    const Point& point = flat.points[p];
    strains.nodes[p].setZero();
    for (Eigen::Index i = 0; i < flat.node_count; ++i)
      strains.nodes[p].middleCols<2>(2 * i) = strain_of(point.gradient.col(i));
    // Gradients of 1 - xi^2 and 1 - eta^2 with the Jacobian of the centre, so that they do no work on constant stress.
    const double ratio = -2.0 * flat.centre.area / (4.0 * point.area);
    strains.modes[p] << strain_of(ratio * point.xi * flat.centre.inverse.col(0)),
        strain_of(ratio * point.eta * flat.centre.inverse.col(1));
  }
  return strains;
}

PlaneMatrix drilling(const Flat& flat) {
  constexpr double fraction = 1e-6;  // of G t, at K6ROT = 1: as Nastran
  PlaneMatrix stiffness = PlaneMatrix::Zero();
  for (Eigen::Index p = 0; p < flat.point_count; ++p) {
    const Point& point = flat.points[p];
    Eigen::Matrix<double, 12, 1> lag = Eigen::Matrix<double, 12, 1>::Zero();
    for (Eigen::Index i = 0; i < flat.node_count; ++i) {
      lag.segment<3>(3 * i) << 0.5 * point.gradient(1, i), -0.5 * point.gradient(0, i), point.shape(i);
    }
    stiffness.noalias() += fraction * point.area * lag * lag.transpose();
  }
  return stiffness;
}

}  // namespace mottle::fem::shell
