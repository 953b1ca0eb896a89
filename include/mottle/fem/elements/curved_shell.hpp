// Stiffness and mass of curved shell elements with mid-edge nodes as constant matrices times numbers of the cards.
// Knows nothing of cards and fields: the assembly multiplies each matrix by its coefficient and adds.
#pragma once

#include <Eigen/Core>

#include "mottle/fem/elements/shell.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// One element. Basic coordinates; by node three translations, then three rotations.
struct CurvedShellInput {
  int node_count = 8;  ///< 6 or 8: corners, then the middles of the edges 1-2, 2-3...
  Eigen::Matrix<double, 3, 8> nodes = Eigen::Matrix<double, 3, 8>::Zero();  ///< around the element, as columns
  double offset = 0.0;                                                      ///< ZOFFS, along the normals at the nodes
  /// Basic; the material's x is its projection on the element. Zero: the tangent along which the first two nodes lie.
  Eigen::Vector3d material_direction = Eigen::Vector3d::Zero();
  double material_angle = 0.0;  ///< THETA, radians, from there about the normal to the material's x
};

/// [6 node x 6 node], symmetric; each is to be multiplied as the parts of the section are.
struct CurvedShellPieces {
  Eigen::MatrixXd membrane, coupling, bending, shear;
  Eigen::MatrixXd drilling;  ///< times G t K6ROT
};

/// Stiffness of a curved shell that is flexible in transverse shear.
///
///   E_ab = (x,a . u,b + x,b . u,a) / 2,   K_ab = (x,a . d,b + n,a . u,b + x,b . d,a + n,b . u,a) / 2,
///   g_a = x,a . d + n . u,a,   d = sum N_i (theta_i x n_i)
///
/// x: position; n: director, interpolated from the normals n_i of the element at its nodes; d: its change. No rigid
/// motion strains the element, whatever its form. Terms of the order of thickness over radius are left out.
///   shear      tied along the edges and to its mean, in the spaces of MITC7 and MITC9; for that d has a bubble
///   membrane   of eight nodes 2 x 2 points, with a bubble of the tangential displacement; what these points do not see
///              is stiffened by bending stiffness / area, which no thin shell notices. Of six nodes tied as MITC6
///   bending    3 x 3, 7 points
/// The bubbles follow the nodes as at least energy for section.bending_over_membrane and bending_over_shear, so that
/// the pieces are exact there, and of second order in the change elsewhere. Drilling: as the flat shell. A section that
/// is rigid in shear is given 1e4 D / area, as part of `bending`.
///
/// @param section  material axes, as ShellSection
/// @throws InvalidInput  nodes that enclose no area or turn over; a material direction across the element
/// Source: [Bathe1989] (shear), [Lee2004] (membrane of six nodes), [Zienkiewicz2013] (reduced integration).
CurvedShellPieces curved_shell_stiffness(const CurvedShellInput& input, const ShellSection& section);

/// Mass at unit mass per area, as shell_mass; lumped: the diagonal of the consistent one, scaled to the total (HRZ).
/// @throws InvalidInput  as curved_shell_stiffness
Eigen::MatrixXd curved_shell_mass(const CurvedShellInput& input, MassKind kind);

/// @throws InvalidInput  as curved_shell_stiffness
double curved_shell_area(const CurvedShellInput& input);

/// Quality of an element's form: its corners as those of a flat shell, and the Jacobian at all nodes.
/// @throws InvalidInput  nodes that enclose no area
ShellQuality curved_shell_quality(const CurvedShellInput& input);

}  // namespace mottle::fem
