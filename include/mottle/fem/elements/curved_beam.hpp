// Stiffness and mass of a beam along a circular arc. Knows nothing of cards and fields.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>

#include "mottle/fem/elements/beam.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// How an arc through two points is given, besides a vector v at the first one that spans its plane.
enum class ArcRule : std::uint8_t {
  center,   ///< the centre lies along v
  tangent,  ///< v is the direction of the arc's tangent at A
  radius,   ///< by its radius; v points away from the centre
  angle     ///< by its angle; v points away from the centre
};

/// An arc of less than half a circle, from end A counter-clockwise about its normal to end B.
struct Arc {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d radial = Eigen::Vector3d::UnitX();  ///< from the centre to end A
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double radius = 1.0;
  double angle = 1.0;  ///< radians, in (0, pi)

  Eigen::Vector3d radial_at(double phi) const { return std::cos(phi) * radial + std::sin(phi) * normal.cross(radial); }
  Eigen::Vector3d tangent_at(double phi) const { return normal.cross(radial_at(phi)); }
  Eigen::Vector3d point(double phi) const { return center + radius * radial_at(phi); }
};

/// @param points  A and B
/// @param number  radius, or angle in degrees, of the rules that need it
/// @throws InvalidInput  a vector or a number with which there is no such arc
Arc arc_between(const std::array<Eigen::Vector3d, 2>& points, const Eigen::Vector3d& v, ArcRule rule, double number);

/// A constant section: plane 1 is the plane of the arc.
struct CurvedBeamSection {
  double area = 0.0;
  double inertia_1 = 0.0, inertia_2 = 0.0;
  double torsion = 0.0;
  double shear_1 = 0.0, shear_2 = 0.0;  ///< K1, K2: shear area / area; 0: rigid in shear
};

/// Stiffness per unit E and mass per unit of mass per length, both between the nodes, basic.
struct CurvedBeamMatrices {
  BeamMatrix stiffness = BeamMatrix::Zero();
  BeamMatrix line = BeamMatrix::Zero();       ///< the translations
  BeamMatrix torsional = BeamMatrix::Zero();  ///< the rotation about the axis, as beam_mass
};

/// A beam along the arc of its centroids, exact for loads at its ends.
///
///   K^-1 of B's motion with A clamped = integral of H' D H ds,  H: section forces and moments by those at B
///
/// with the energy of curved bars (Winkler): N^2/EA + M1^2/EI1 + 2 N M1/(E A R) + M2^2/EI2 + T^2/GJ and shear, where
/// I1 = A R e, e being the neutral axis' distance from the centroid, or the section's I1. The consistent mass
/// follows the deflections of the same beam under loads at its ends; the lumped one is half at each end.
///
/// @param arc               of the centroids
/// @param nodes             basic; each is rigidly connected with its end of the arc
/// @param young_over_shear  E / G
/// @throws InvalidInput     numbers that are not positive
/// Source: [Przemieniecki1968], ch. 5 (inverse of the flexibility).
CurvedBeamMatrices curved_beam(const Arc& arc, const std::array<Eigen::Vector3d, 2>& nodes,
                               const CurvedBeamSection& section, double young_over_shear, MassKind kind);

}  // namespace mottle::fem
