// Matrices of the solid elements, as pure functions of shape, node positions and elasticity. Knows nothing of cards,
// materials or numbering: the assembly supplies those, and adds the element's id to errors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "mottle/layers.hpp"

namespace mottle::fem {

enum class SolidShape : std::uint8_t {
  hexahedron8,
  wedge6,
  tetrahedron4,
  tetrahedron10,
  pyramid5,
  hexahedron20,
  wedge15,
  pyramid13,
};

/// Diagonal mass by scaling the consistent diagonal to the exact total (HRZ), or the mass of the shape functions. A
/// pyramid with five nodes has the sums of the rows, one with thirteen a scale that varies along its height: both keep
/// its centre of gravity.
enum class MassKind : std::uint8_t { lumped, consistent };

/// Quality of an element's form.
struct SolidQuality {
  double jacobian_ratio = 1.0;  ///< least Jacobian determinant (corners, integration points) / |mean|; <= 0: inverted
  double aspect_ratio =
      1.0;  ///< longest edge / least edge or height, 1 for cube, even prism, regular tetrahedron and pyramid
};

/// Number of nodes of a shape; the columns of `nodes` below.
int node_count(SolidShape shape);

/// Ends of the edges, in the order in which their mid-edge nodes follow the corners; of linear shapes as well.
std::span<const std::array<int, 2>> solid_edges(SolidShape shape);

/// Elasticity matrix of an isotropic material, order xx yy zz xy yz zx with engineering shear.
///
///   C_ii = lambda + 2 G,  C_ij = lambda,  C_shear = G;  G = E / (2 (1 + nu)),  lambda = 2 G nu / (1 - 2 nu)
///
/// @param young    E > 0, force / length^2
/// @param poisson  nu, in (-1, 0.5)
/// @throws InvalidInput  a value outside its range
Eigen::Matrix<double, 6, 6> isotropic_elasticity(double young, double poisson);

/// Elasticity matrix in basic axes of a material that is described in axes of its own.
///
/// @param elasticity  order xx yy zz xy yz zx with engineering shear, in the material's axes
/// @param axes        the material's x, y, z in basic coordinates, as columns; orthonormal
Eigen::Matrix<double, 6, 6> turned_elasticity(const Eigen::Matrix<double, 6, 6>& elasticity,
                                              const Eigen::Matrix3d& axes);

/// Stiffness in basic coordinates, degrees of freedom by node (u1 v1 w1 u2 ...); symmetric to the last bit.
///
///   K = K_uu - K_ua K_aa^-1 K_au,   K = sum over integration points of w det(J) B' C B
///
/// u: shape functions; a: incompatible modes that let the linear shapes bend without locking, condensed here. Their
/// gradients are taken with the Jacobian of the centre, scaled by det(J_0) / det(J), so that they do no work on a
/// constant stress and a distorted element passes the patch test.
///   hexahedron8    modes 1 - xi^2, 1 - eta^2, 1 - zeta^2 in each direction; 2 x 2 x 2 points
///   wedge6         modes 1 - zeta^2 and L1 L2, L2 L3, L3 L1 less their mean gradient, in each direction; 3 x 2 points
///                  (thin layers of wedges, extruded through the thickness, stay too stiff in bending: use bricks)
///   pyramid5       bilinear on the base, linear towards the apex (rational shape functions); 2 x 2 x 2 points
///   tetrahedron4   constant strain
///   tetrahedron10  quadratic; 4 points, exact where edges are straight and evenly divided, else 14
///   hexahedron20   serendipity; 3 x 3 x 3 points
///   wedge15        serendipity; 6 x 3 points
///   pyramid13      rational shape functions; 4 x 4 x 4 points
/// K(s C) = s K(C). Shapes with modes are not additive in C: K(C1 + C2) is not K(C1) + K(C2).
///
/// @param nodes       [3 x node], basic, in Nastran's order (a pyramid's apex after its base; then mid-edge nodes as
///                    solid_edges)
/// @param elasticity  symmetric positive definite, order as isotropic_elasticity
/// @return            [3 node x 3 node], force / length
/// @throws InvalidInput  Jacobian determinant not positive at an integration point (message without file and element)
/// Source: [Wilson1973], [Taylor1976]; [Zienkiewicz2013] for the quadratic ones, [Bedrosian1992] for the pyramids.
Eigen::MatrixXd solid_stiffness(SolidShape shape, const Eigen::Ref<const Eigen::Matrix3Xd>& nodes,
                                const Eigen::Matrix<double, 6, 6>& elasticity);

/// Mass matrix at unit density, degrees of freedom as solid_stiffness; its total in each direction is the volume.
///
/// Consistent: exact where edges are straight. Lumped: diagonal, all
/// positive.
///
/// @param nodes  [3 x node], basic
/// @return       [3 node x 3 node], length^3
/// @throws InvalidInput  as solid_stiffness
/// Source: [Hinton1976] for the lumped one.
Eigen::MatrixXd solid_mass(SolidShape shape, const Eigen::Ref<const Eigen::Matrix3Xd>& nodes, MassKind kind);

/// Volume, length^3.
/// @throws InvalidInput  as solid_stiffness
double solid_volume(SolidShape shape, const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

/// Quality of an element's form; also of one that the other functions refuse.
SolidQuality solid_quality(SolidShape shape, const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

}  // namespace mottle::fem
