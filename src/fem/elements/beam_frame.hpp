// Axes of a beam, matrices of its ends and the release of pins, shared by prismatic and tapered beams.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "mottle/fem/elements/beam.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem::beam {

constexpr Components bit(Eigen::Index component) {
  return static_cast<Components>(1u << component);
}
inline constexpr Components k_axial = bit(0), k_twist = bit(3);
inline constexpr Components k_plane_1 = bit(1) | bit(5), k_plane_2 = bit(2) | bit(4);

struct Frame {
  double length = 0.0;
  BeamMatrix to_local = BeamMatrix::Zero();  ///< from the nodes in basic coordinates to the ends in element axes
};

/// Axis of a bar and its length, after the check that it has one.
std::pair<Eigen::Vector3d, double> axis_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

Frame frame_of(const BeamGeometry& geometry);

/// Copies the lower triangle to the upper one.
BeamMatrix symmetric(BeamMatrix matrix);

BeamMatrix to_basic(const Frame& frame, const BeamMatrix& local);

/// A matrix between the points (y, z) = `place` of both end sections, as one between the axes' ends; local.
BeamMatrix from_place(const Eigen::Vector2d& place, const BeamMatrix& local);

/// [[ends, far], [far, ends]] in one component.
BeamMatrix two_ends(Eigen::Index component, double ends, double far);

/// Deformations of a bar clamped at A: deflections of B in planes 1 and 2, then its slopes. Slopes v' = rotation z,
/// w' = -rotation y make both planes alike.
Eigen::Matrix<double, 4, 12> deformation(double length);

/// Local bending stiffness of both planes per unit E, exact for end loads.
/// @param inertia  [[I1, I12], [I12, I2]]
/// @param shear    E / (K A G) of both planes; 0: rigid
BeamMatrix bending(double length, const Eigen::Matrix2d& inertia, const Eigen::Vector2d& shear);

/// Condenses the pinned ones among `components` out of a local stiffness, and applies the same reduction to `mass`.
void release(const std::array<Components, 2>& pins, Components components, BeamMatrix& stiffness,
             BeamMatrix* mass = nullptr);

/// The same for consistent masses, local, by the stiffness of a prismatic bar without shear.
void release_mass(const BeamGeometry& geometry, double length, BeamMatrix& line, BeamMatrix& torsional);

/// @throws InvalidInput  numbers that no section has
void require_sound(const BeamSection& section, double young_over_shear);

/// As Nastran: a released component must have stiffness.
void require_stiffness_at_pins(const std::array<Components, 2>& pins, const BeamSection& section);

}  // namespace mottle::fem::beam
