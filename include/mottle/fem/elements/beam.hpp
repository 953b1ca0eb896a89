// Stiffness and mass of two-node bars, beams and rods as constant matrices times numbers of the cards. Knows nothing
// of cards and fields: the assembly multiplies each matrix by its coefficient and adds.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/solid.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Basic coordinates; by node three translations, then three rotations.
using BeamMatrix = Eigen::Matrix<double, 12, 12>;

/// Where a beam lies. Its axis x runs from end A to end B, an end being node + offset; z = x cross orientation.
struct BeamGeometry {
  std::array<Eigen::Vector3d, 2> nodes = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::array<Eigen::Vector3d, 2> offsets = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< WA, WB, basic
  Eigen::Vector3d orientation = Eigen::Vector3d::UnitZ();  ///< v, basic: plane 1 is spanned by the axis and v
  std::array<Components, 2> pins = {};                     ///< released at ends A and B, in element axes
};

/// Numbers of a cross-section, in Nastran's naming: inertia_1 resists bending in plane 1 (x-y).
struct BeamSection {
  double area = 0.0;
  double inertia_1 = 0.0, inertia_2 = 0.0;  ///< integrals of y^2 and z^2
  double inertia_12 = 0.0;                  ///< integral of y z
  double torsion = 0.0;
  double shear_1 = 0.0, shear_2 = 0.0;  ///< K1, K2: shear area / area in planes 1 and 2; 0: rigid in shear
  Eigen::Vector2d neutral_axis = Eigen::Vector2d::Zero();  ///< N1, N2: its y and z from the shear centre, the axis x
};

/// What a unit matrix is to be multiplied by. `E`, `G`: the matrix holds the given section's numbers itself.
enum class BeamCoefficient : std::uint8_t { EA, GJ, EI1, EI2, EI12, E, G };

struct BeamPiece {
  BeamCoefficient coefficient = BeamCoefficient::EA;
  BeamMatrix matrix = BeamMatrix::Zero();  ///< symmetric to the last bit
};

/// Stiffness of a beam as unit matrices, exact for a prismatic bar loaded at its ends.
///
///   K = sum over the pieces of coefficient * matrix
///
/// Bending is EI1, EI2 and, where the section has an inertia_12, EI12. Shear flexibility makes bending a rational
/// function of I1, A and E/G, and pins do the same where inertia_12 couples the planes; bending is then one piece E,
/// which holds for this section and this E/G only. Pins release the ends of the bar (beyond the offsets). Where the
/// neutral axis lies beside the shear centre, EA acts along the neutral axis; with pins in bending or along the axis it
/// is part of the piece E.
///
/// @param young_over_shear  E / G, > 0; used only where the section is flexible in shear
/// @return                  EA, GJ, then bending
/// @throws InvalidInput     ends that coincide, an orientation along the axis, a negative or infinite number, pins that
///                          leave a mechanism or release a component without stiffness
/// Source: [Przemieniecki1968], ch. 5.
std::vector<BeamPiece> beam_stiffness(const BeamGeometry& geometry, const BeamSection& section,
                                      double young_over_shear);

/// Mass of a beam as unit matrices.
struct BeamMass {
  BeamMatrix line = BeamMatrix::Zero();       ///< times rho A + nonstructural mass: the translations
  BeamMatrix torsional = BeamMatrix::Zero();  ///< times rho (I1 + I2): the rotation about the axis
};

/// Mass of a beam per unit of its coefficients; its line lies at `center` (y, z in element axes).
///
/// Lumped: half of it at each end, beyond the offsets; pins do not touch it. Consistent: cubic deflections without
/// shear flexibility; along and about the axis the mean of linear and lumped (5/12 and 1/12), as in Nastran, whose
/// frequencies converge with h^4 instead of h^2. Released components follow the rest of the bar as in the stiffness
/// without shear and inertia_12.
///
/// @throws InvalidInput  the geometry, as beam_stiffness
/// Source: [Przemieniecki1968], ch. 11.
BeamMass beam_mass(const BeamGeometry& geometry, MassKind kind,
                   const Eigen::Vector2d& center = Eigen::Vector2d::Zero());

/// Stiffness of a rod: axial and torsional, as pieces EA and GJ.
///
/// @param nodes          both ends, basic
/// @throws InvalidInput  ends that coincide
std::array<BeamPiece, 2> rod_stiffness(const std::array<Eigen::Vector3d, 2>& nodes);

/// Mass of a rod per unit of rho A + nonstructural mass, without rotary inertia.
///
/// Consistent: along the axis 5/12 and 1/12, as a beam; across it lumped, for a rod stays straight without stiffness.
///
/// @throws InvalidInput  ends that coincide
BeamMatrix rod_mass(const std::array<Eigen::Vector3d, 2>& nodes, MassKind kind);

}  // namespace mottle::fem
