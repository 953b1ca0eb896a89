// Stiffness and mass of flat shell elements with three or four nodes as constant matrices times numbers of the cards.
// Knows nothing of cards and fields: the assembly multiplies each matrix by its coefficient and adds.
#pragma once

#include <Eigen/Core>

#include "mottle/fem/elements/solid.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Basic coordinates; by node three translations, then three rotations. A triangle fills the leading 18 x 18.
using ShellMatrix = Eigen::Matrix<double, 24, 24>;

/// One element. Everything here stays as it is while parameters move; what they move are the coefficients below.
struct ShellInput {
  int node_count = 4;                                                       ///< 3 or 4
  Eigen::Matrix<double, 3, 4> nodes = Eigen::Matrix<double, 3, 4>::Zero();  ///< basic, around the element, as columns
  double offset = 0.0;                                                      ///< ZOFFS, along the normal
  double poisson_membrane = 0.3, poisson_bending = 0.3;
  /// D / (G t TS/T) at the card's values, length^2: how soft the plate is in shear compared with bending; of one
  /// material (12 I/T^3) t^2 / (6 (1 - nu) TS/T). 0: rigid in shear (MID3 blank), the piece `shear` is then zero. The
  /// deformation of the edges is shared between bending and shear by it, so that the pieces hold at this value only.
  double shear_flexibility = 0.0;
  /// Basic; the material's x is its projection on the element. Zero: from the first node to the second.
  Eigen::Vector3d material_direction = Eigen::Vector3d::Zero();
  double material_angle = 0.0;  ///< THETA, radians, from there about the normal to the material's x
};

/// Unit matrices; each is symmetric to the last bit.
struct ShellPieces {
  ShellMatrix membrane = ShellMatrix::Zero();  ///< times E t of the membrane material
  ShellMatrix bending = ShellMatrix::Zero();   ///< times E t^3 (12 I/T^3) of the bending material
  ShellMatrix shear = ShellMatrix::Zero();     ///< times G t (TS/T) of the shear material
  ShellMatrix drilling = ShellMatrix::Zero();  ///< times G t K6ROT of the membrane material
};

/// Stiffness of a shell as unit matrices.
///
///   K = E t membrane + E t^3 (12 I/T^3) bending + G t (TS/T) shear + G t K6ROT drilling
///
/// Membrane: of a quadrilateral with incompatible modes, of a triangle constant strain, as CTRIA3. Plate: rotations
/// linear, plus a quadratic part along the edges that follows the deflection but for the shear that the edge can take;
/// the shear is tied at the mid-edges (DKMQ, DKMT; MITC4 where cells are small against the thickness, DKQ and DKT where
/// it is thin). One cell across a thin strip bends as the strip; linear rotations alone would lock there. Drilling:
/// 1e-6 times the integral of (rotation about the normal - rotation of the membrane)^2. At K6ROT = 100 this is weak:
/// where the cells of a curved shell are hardly larger than its thickness, raise K6ROT to 1e4 (a roof of 48 x 48 cells,
/// of 1.5 and 2 thicknesses, sinks 2 % too far).
///
/// The element is flat, across both diagonals. Rigid links lead from there to the nodes of a warped quadrilateral, and
/// to an offset. At a warped corner the rotation about the corner's own normal is that of the membrane, so that moments
/// which change planes from one element to the next are carried by forces instead of the weak drilling stiffness.
///
/// @throws InvalidInput  nodes that enclose no area or turn inwards, a Poisson's ratio outside (-1, 0.5], a negative
///                       shear flexibility
/// Source: [Taylor1976] (membrane), [Bathe1985] (tied shear), [Katili1993] (edges).
ShellPieces shell_stiffness(const ShellInput& input);

/// Stiffness of a section that depends on direction, in material axes; the section's x runs along
/// ShellInput::material_direction, turned by material_angle.
///
///   (N, M) = (A B; B D) (strain, curvature),   Q = S (transverse shear)
///
/// Order xx, yy, engineering xy; xz, yz. Positive curvature stretches the side to which the normal points.
struct ShellSection {
  Eigen::Matrix3d membrane = Eigen::Matrix3d::Zero();  ///< A
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();  ///< B
  Eigen::Matrix3d bending = Eigen::Matrix3d::Zero();   ///< D
  Eigen::Matrix2d shear = Eigen::Matrix2d::Zero();     ///< S; zero: rigid in shear
  /// What the piece `bending` is to be multiplied by / what `shear` is: both are one where A, B, D, S are whole.
  double bending_over_shear = 1.0;
  double bending_over_membrane = 1.0;  ///< the same of `membrane`; of curved shells only
};

/// Stiffness of a shell with such a section, as four pieces: those of A, D and S, and of the drilling rotation.
///
/// The formulation is that of the isotropic shell. `coupling` must be zero; incompatible modes make the membrane of a
/// quadrilateral homogeneous in A, but not additive. D and S of each edge's direction are held against each other
/// for the fraction of its shear that becomes bending.
///
/// @param input  its Poisson's ratios and shear flexibility are not used
/// @throws InvalidInput  the geometry, as the isotropic shell; a material direction across the element
ShellPieces shell_stiffness(const ShellInput& input, const ShellSection& section);

struct LaminatePieces {
  ShellMatrix section = ShellMatrix::Zero();   ///< membrane, bending, their coupling, shear
  ShellMatrix drilling = ShellMatrix::Zero();  ///< times the drilling stiffness G t K6ROT
};

/// Stiffness of a shell whose B need not be zero.
/// @throws InvalidInput  as above
LaminatePieces laminate_stiffness(const ShellInput& input, const ShellSection& section);

/// Mass at unit mass per area: translations only, no rotary inertia of the thickness (as Nastran).
///
/// Lumped: integrals of the shape functions, at the nodes. Consistent: integrals of their products. Both sit at the
/// offset position.
///
/// @throws InvalidInput  the geometry, as shell_stiffness
ShellMatrix shell_mass(const ShellInput& input, MassKind kind);

/// Area of the flat element.
/// @throws InvalidInput  as shell_stiffness
double shell_area(const ShellInput& input);

/// Quality of an element's form; the ideal is a square or an equilateral triangle.
struct ShellQuality {
  double warp = 0.0;            ///< distance of the nodes from the mean plane / mean half diagonal; 0 is flat
  double aspect = 1.0;          ///< longest edge / shortest edge
  double skew = 90.0;           ///< degrees; least angle between the lines through mid-edges, of a triangle at a corner
  double jacobian_ratio = 1.0;  ///< least / largest Jacobian determinant at the corners; <= 0: it turns inwards
};

/// @throws InvalidInput  nodes that enclose no area
ShellQuality shell_quality(const ShellInput& input);

}  // namespace mottle::fem
