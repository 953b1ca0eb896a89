// Stiffness and mass of beams whose section changes along the axis. Knows nothing of cards and fields.
#pragma once

#include <span>
#include <vector>

#include "mottle/fem/elements/beam.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// A section at a fraction of the length; between two of them its numbers vary linearly.
struct BeamSectionAt {
  double position = 0.0;  ///< 0 at end A, 1 at end B
  BeamSection section = {};
};

/// Stiffness of a tapered beam as pieces of E (axial and bending) and G (torsion), exact for loads at its ends.
///
///   K^-1 of the deformations of the beam clamped at A = integral of the flexibilities 1/(E A), (E I)^-1 of both
///   planes, 1/(G J) and 1/(K A G) under unit loads at B
///
/// The integrals are sums of three Gauss points in each of 32 parts between neighbouring sections: exact to 1e-8 where
/// a number changes tenfold.
///
/// @param sections           ascending in position, the first at 0, the last at 1; A, I1, I2 > 0, J > 0 or 0 in all
/// @param young_over_shear   E / G, as beam_stiffness
/// @throws InvalidInput      as beam_stiffness; sections that are not as above
/// Source: [Przemieniecki1968], ch. 5 (inverse of the flexibility).
std::vector<BeamPiece> tapered_beam_stiffness(const BeamGeometry& geometry, std::span<const BeamSectionAt> sections,
                                              double young_over_shear);

/// A number of the section along the axis, linear between the places.
struct LineWeight {
  double position = 0.0;
  double weight = 0.0;
};

/// Mass of a beam whose mass per length is this weight; linear in the weights.
///
/// Lumped: each end takes the mass times its share of the lever, so that the centre of gravity is kept. Consistent:
/// cubic deflections, along and about the axis the mean of linear and lumped, as beam_mass, which it is for a uniform
/// weight of one.
///
/// @throws InvalidInput  the geometry, as beam_stiffness
BeamMass tapered_beam_mass(const BeamGeometry& geometry, std::span<const LineWeight> weights, MassKind kind);

}  // namespace mottle::fem
