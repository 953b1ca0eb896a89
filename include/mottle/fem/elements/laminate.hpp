// Stiffness of a laminate's section from its plies: classical lamination theory and its transverse shear.
#pragma once

#include <Eigen/Core>
#include <span>

#include "mottle/fem/elements/shell.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Plane stress of an orthotropic ply, order 11, 22, engineering 12.
///
///   Q11 = E1 / d,  Q22 = E2 / d,  Q12 = nu12 E2 / d,  Q33 = G12,  d = 1 - nu12^2 E2 / E1
///
/// @throws InvalidInput  E1, E2 <= 0, G12 < 0 or nu12^2 E2 >= E1: no material has that
/// Source: [Jones1999], ch. 2.
Eigen::Matrix3d orthotropic_plane_stress(double young_1, double young_2, double poisson_12, double shear_12);

struct LaminatePly {
  Eigen::Matrix3d elasticity = Eigen::Matrix3d::Zero();         ///< plane stress in ply axes
  Eigen::Matrix2d shear_flexibility = Eigen::Matrix2d::Zero();  ///< inverse of the transverse shear moduli 1z, 2z
  double thickness = 0.0;
  double angle = 0.0;  ///< radians, from the laminate's x to the ply's 1, about the normal
};

/// A, B, D of plies stacked from z = bottom, and their transverse shear.
///
///   (A, B, D) = sum over the plies of Q * integral of (1, z, z^2) dz
///   S^-1 = integral of g' F g dz,   g_x(z) = (1/R_x) integral from the bottom to z of Q_xx (z_x - s) ds
///
/// g: shear stress per shear force where the laminate is bent about one axis, from equilibrium along x with neutral
/// axis z_x and R_x = integral of Q_xx (s - z_x)^2 ds; the same along y. F: shear flexibility of each ply. S^-1 is the
/// energy of these stresses; one isotropic ply has S = 5/6 G t, and S does not depend on `bottom`. Plies that are rigid
/// in shear add nothing to S^-1; where all are, S is zero: rigid.
///
/// @param plies          from the bottom
/// @param bottom         z of the lowest face, length
/// @throws InvalidInput  no ply, a thickness that is not positive, a laminate that is rigid in shear in one direction
///                       only
/// Source: [Jones1999], ch. 4; [Rolfes1997] for the shear.
ShellSection laminate_section(std::span<const LaminatePly> plies, double bottom);

}  // namespace mottle::fem
