#include "mottle/fem/elements/beam.hpp"

#include <Eigen/LU>
#include <cmath>

#include "fem/elements/beam_frame.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using beam::k_axial;
using beam::k_plane_1;
using beam::k_plane_2;
using beam::k_twist;
using beam::two_ends;

BeamPiece piece(BeamCoefficient coefficient, const beam::Frame& frame, const std::array<Components, 2>& pins,
                Components components, BeamMatrix local) {
  beam::release(pins, components, local);
  return {coefficient, beam::to_basic(frame, local)};
}

}  // namespace

std::vector<BeamPiece> beam_stiffness(const BeamGeometry& geometry, const BeamSection& section,
                                      double young_over_shear) {
  beam::require_sound(section, young_over_shear);
  beam::require_stiffness_at_pins(geometry.pins, section);
  const beam::Frame frame = beam::frame_of(geometry);
  const double length = frame.length;
  const std::array<Components, 2>& pins = geometry.pins;
  using enum BeamCoefficient;
  const Components both_planes = k_plane_1 | k_plane_2;
  const int pinned = pins[0] | pins[1];
  const bool is_eccentric = !section.neutral_axis.isZero(0.0);
  const BeamMatrix axial = beam::from_place(section.neutral_axis, two_ends(0, 1.0 / length, -1.0 / length));
  const bool is_axial_coupled = is_eccentric && (pinned & (both_planes | k_axial)) != 0;
  std::vector<BeamPiece> pieces = {piece(GJ, frame, pins, k_twist, two_ends(3, 1.0 / length, -1.0 / length))};
  if (!is_axial_coupled) pieces.insert(pieces.begin(), piece(EA, frame, pins, k_axial, axial));
  const bool is_flexible_in_shear = section.shear_1 > 0.0 || section.shear_2 > 0.0;
  const bool is_pinned = (pinned & both_planes) != 0;
  if (is_axial_coupled || is_flexible_in_shear || (is_pinned && section.inertia_12 != 0.0)) {
    const auto flexibility = [&](double factor) {
      return factor > 0.0 ? young_over_shear / (factor * section.area) : 0.0;
    };
    const Eigen::Matrix2d inertia{{section.inertia_1, section.inertia_12}, {section.inertia_12, section.inertia_2}};
    BeamMatrix bent = beam::bending(length, inertia, {flexibility(section.shear_1), flexibility(section.shear_2)});
    if (is_axial_coupled) bent += section.area * axial;
    pieces.push_back(piece(E, frame, pins, is_axial_coupled ? both_planes | k_axial : both_planes, bent));
    return pieces;
  }
  const Eigen::Vector2d rigid = Eigen::Vector2d::Zero();
  pieces.push_back(
      piece(EI1, frame, pins, k_plane_1, beam::bending(length, Eigen::Vector2d(1.0, 0.0).asDiagonal(), rigid)));
  pieces.push_back(
      piece(EI2, frame, pins, k_plane_2, beam::bending(length, Eigen::Vector2d(0.0, 1.0).asDiagonal(), rigid)));
  if (section.inertia_12 != 0.0) {
    const Eigen::Matrix2d coupling{{0.0, 1.0}, {1.0, 0.0}};
    pieces.push_back(piece(EI12, frame, pins, 0, beam::bending(length, coupling, rigid)));
  }
  return pieces;
}

namespace {

/// Cubic deflections of both planes, local, per unit mass per length.
BeamMatrix cubic_mass(double length) {
  BeamMatrix mass = BeamMatrix::Zero();
  constexpr std::array<Eigen::Index, 2> deflection = {1, 2}, rotation = {5, 4};
  for (Eigen::Index plane = 0; plane < 2; ++plane) {
    const Eigen::Index v = deflection[plane], r = rotation[plane];
    const double arm = plane == 0 ? length : -length;  // slope w' = -rotation y
    mass += two_ends(v, 156.0, 54.0) + two_ends(r, 4.0 * arm * arm, -3.0 * arm * arm);
    mass(r, v) = 22.0 * arm;
    mass(6 + r, 6 + v) = -22.0 * arm;
    mass(6 + r, v) = -13.0 * arm;
    mass(6 + v, r) = 13.0 * arm;
  }
  mass *= length / 420.0;
  mass.triangularView<Eigen::StrictlyUpper>() = mass.transpose();
  return mass;
}

}  // namespace

BeamMass beam_mass(const BeamGeometry& geometry, MassKind kind, const Eigen::Vector2d& center) {
  const beam::Frame frame = beam::frame_of(geometry);
  const double length = frame.length;
  BeamMatrix line = BeamMatrix::Zero(), torsional = BeamMatrix::Zero();
  if (kind == MassKind::lumped) {
    for (Eigen::Index component = 0; component < 3; ++component) line += two_ends(component, 0.5 * length, 0.0);
    torsional = two_ends(3, 0.5 * length, 0.0);
    line = beam::from_place(center, line);
  } else {
    line = beam::from_place(center, two_ends(0, 5.0 / 12.0 * length, length / 12.0) + cubic_mass(length));
    torsional = two_ends(3, 5.0 / 12.0 * length, length / 12.0);
    beam::release_mass(geometry, length, line, torsional);
  }
  return {.line = beam::to_basic(frame, line), .torsional = beam::to_basic(frame, torsional)};
}

std::array<BeamPiece, 2> rod_stiffness(const std::array<Eigen::Vector3d, 2>& nodes) {
  const auto [axis, length] = beam::axis_of(nodes[0], nodes[1]);
  const Eigen::Matrix3d block = axis * axis.transpose() / length;
  std::array<BeamPiece, 2> pieces;
  pieces[0].coefficient = BeamCoefficient::EA;
  pieces[1].coefficient = BeamCoefficient::GJ;
  for (Eigen::Index first = 0; first < 2; ++first) {
    for (Eigen::Index second = 0; second < 2; ++second) {
      const double sign = first == second ? 1.0 : -1.0;
      pieces[0].matrix.block<3, 3>(6 * first, 6 * second) = sign * block;
      pieces[1].matrix.block<3, 3>(6 * first + 3, 6 * second + 3) = sign * block;
    }
  }
  return pieces;
}

BeamMatrix rod_mass(const std::array<Eigen::Vector3d, 2>& nodes, MassKind kind) {
  const auto [axis, length] = beam::axis_of(nodes[0], nodes[1]);
  BeamMatrix mass = BeamMatrix::Zero();
  for (Eigen::Index component = 0; component < 3; ++component) mass += two_ends(component, 0.5 * length, 0.0);
  if (kind == MassKind::lumped) return mass;
  const Eigen::Matrix3d shared = length / 12.0 * axis * axis.transpose();
  for (Eigen::Index first = 0; first < 2; ++first) {
    for (Eigen::Index second = 0; second < 2; ++second) {
      mass.block<3, 3>(6 * first, 6 * second) += (first == second ? -1.0 : 1.0) * shared;
    }
  }
  return beam::symmetric(mass);
}

}  // namespace mottle::fem
