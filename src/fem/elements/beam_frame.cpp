#include "fem/elements/beam_frame.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "fem/assembly/rigid_motion.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem::beam {

BeamMatrix symmetric(BeamMatrix matrix) {
  matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
  return matrix;
}

BeamMatrix to_basic(const Frame& frame, const BeamMatrix& local) {
  return symmetric(frame.to_local.transpose() * local * frame.to_local);
}

std::pair<Eigen::Vector3d, double> axis_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  require(a.allFinite() && b.allFinite(), "beam: a coordinate is not a finite number");
  const double length = (b - a).norm();
  // Below this the direction is made of rounding errors of the coordinates.
  require(length > 1e-12 * std::max(a.norm(), b.norm()),
          "beam: both ends lie at ({:g}, {:g}, {:g}), two different points are needed", a.x(), a.y(), a.z());
  return {(b - a) / length, length};
}

Frame frame_of(const BeamGeometry& geometry) {
  const Eigen::Vector3d a = geometry.nodes[0] + geometry.offsets[0], b = geometry.nodes[1] + geometry.offsets[1];
  const auto [x, length] = axis_of(a, b);
  const Eigen::Vector3d normal = x.cross(geometry.orientation);
  require(normal.norm() > 1e-6 * geometry.orientation.norm(),
          "beam: the orientation ({:g}, {:g}, {:g}) runs along the axis, a direction across it is needed",
          geometry.orientation.x(), geometry.orientation.y(), geometry.orientation.z());
  Eigen::Matrix3d axes;
  axes.row(0) = x;
  axes.row(2) = normal.normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  Frame frame{.length = length};
  for (Eigen::Index end = 0; end < 2; ++end) {
    frame.to_local.block<3, 3>(6 * end, 6 * end) = axes;
    frame.to_local.block<3, 3>(6 * end + 3, 6 * end + 3) = axes;
    frame.to_local.block<3, 3>(6 * end, 6 * end + 3) = -axes * cross_matrix(geometry.offsets[end]);
  }
  return frame;
}

BeamMatrix from_place(const Eigen::Vector2d& place, const BeamMatrix& local) {
  if (place.isZero(0.0)) return local;
  BeamMatrix motion = BeamMatrix::Identity();
  for (Eigen::Index end = 0; end < 2; ++end)
    motion.block<3, 3>(6 * end, 6 * end + 3) = -cross_matrix({0.0, place.x(), place.y()});
  return symmetric(motion.transpose() * local * motion);
}

BeamMatrix two_ends(Eigen::Index component, double ends, double far) {
  BeamMatrix matrix = BeamMatrix::Zero();
  matrix(component, component) = matrix(6 + component, 6 + component) = ends;
  matrix(component, 6 + component) = matrix(6 + component, component) = far;
  return matrix;
}

Eigen::Matrix<double, 4, 12> deformation(double length) {
  Eigen::Matrix<double, 4, 12> result = Eigen::Matrix<double, 4, 12>::Zero();
  constexpr std::array<Eigen::Index, 2> deflection = {1, 2}, rotation = {5, 4};
  constexpr std::array<double, 2> slope = {1.0, -1.0};
  for (Eigen::Index plane = 0; plane < 2; ++plane) {
    result(plane, deflection[plane]) = -1.0;
    result(plane, 6 + deflection[plane]) = 1.0;
    result(plane, rotation[plane]) = -length * slope[plane];
    result(2 + plane, rotation[plane]) = -slope[plane];
    result(2 + plane, 6 + rotation[plane]) = slope[plane];
  }
  return result;
}

BeamMatrix bending(double length, const Eigen::Matrix2d& inertia, const Eigen::Vector2d& shear) {
  // The stiffness of the deformations inverts the flexibility (L^3/3 I^-1 + L shear, L^2/2 I^-1; ., L I^-1), here
  // without I^-1, for a plane may have no inertia.
  const Eigen::Matrix2d phi = 12.0 / (length * length) * Eigen::Matrix2d(shear.asDiagonal());
  const Eigen::Matrix2d softened = (Eigen::Matrix2d::Identity() + inertia * phi).inverse() * inertia;
  const Eigen::Matrix2d q = 12.0 / (length * length * length) * softened;
  Eigen::Matrix4d stiffness;
  stiffness << q, -0.5 * length * q, -0.5 * length * q, inertia / length + 0.25 * length * length * q;
  const Eigen::Matrix<double, 4, 12> deformed = deformation(length);
  return symmetric(deformed.transpose() * stiffness * deformed);
}

void release(const std::array<Components, 2>& pins, Components components, BeamMatrix& stiffness, BeamMatrix* mass) {
  const BeamMatrix whole = stiffness;
  for (Eigen::Index i = 0; i < 12; ++i) {
    if ((pins[i / 6] & components & bit(i % 6)) == 0) continue;
    // 1e-9: what cancellation leaves of a stiffness that the other pins have taken away; a hinge leaves a quarter.
    require(stiffness(i, i) > 1e-9 * whole(i, i),
            "beam: the pin at end {} in component {} makes a mechanism with the other pins, release fewer",
            i < 6 ? 'A' : 'B', i % 6 + 1);
    Eigen::Matrix<double, 12, 1> follow = -stiffness.col(i) / stiffness(i, i);
    follow(i) = -1.0;  // the row and column below become zero: nothing moves this end any more
    if (mass != nullptr) {
      BeamMatrix reduction = BeamMatrix::Identity();
      reduction.row(i) = follow.transpose();
      reduction(i, i) = 0.0;
      *mass = reduction.transpose() * *mass * reduction;
    }
    const Eigen::Matrix<double, 12, 1> column = stiffness.col(i);
    stiffness -= column * (column.transpose() / column(i));
    stiffness.col(i).setZero();
    stiffness.row(i).setZero();
  }
}

void release_mass(const BeamGeometry& geometry, double length, BeamMatrix& line, BeamMatrix& torsional) {
  BeamMatrix axial = two_ends(0, 1.0, -1.0), twist = two_ends(3, 1.0, -1.0);
  BeamMatrix bent = bending(length, Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero());
  release(geometry.pins, k_axial, axial, &line);
  release(geometry.pins, k_twist, twist, &torsional);
  release(geometry.pins, k_plane_1 | k_plane_2, bent, &line);
}

void require_sound(const BeamSection& section, double young_over_shear) {
  for (const double number :
       {section.area, section.inertia_1, section.inertia_2, section.torsion, section.shear_1, section.shear_2}) {
    require(std::isfinite(number) && number >= 0.0, "beam section: {:g} is not allowed, a number >= 0 is needed",
            number);
  }
  require(section.neutral_axis.allFinite(), "beam section: the neutral axis lies nowhere");
  const double product = section.inertia_1 * section.inertia_2;
  require(section.inertia_12 * section.inertia_12 <= product * (1.0 + 1e-12),
          "beam section: I12 = {:g} is larger than the root of I1 I2 = {:g}, no section has that", section.inertia_12,
          std::sqrt(product));
  if (section.shear_1 > 0.0 || section.shear_2 > 0.0) {
    require(section.area > 0.0, "beam section: K1 = {:g} and K2 = {:g} need an area > 0", section.shear_1,
            section.shear_2);
    require(std::isfinite(young_over_shear) && young_over_shear > 0.0,
            "beam: E / G is {:g}, a number > 0 is needed for shear flexibility", young_over_shear);
  }
}

void require_stiffness_at_pins(const std::array<Components, 2>& pins, const BeamSection& section) {
  const int pinned = pins[0] | pins[1];
  const auto check = [pinned](Components components, double number, const char* name) {
    require((pinned & components) == 0 || number > 0.0, "beam: a pin releases a component whose {} is zero", name);
  };
  check(k_axial, section.area, "area");
  check(k_twist, section.torsion, "torsion constant J");
  check(k_plane_1, section.inertia_1, "inertia I1");
  check(k_plane_2, section.inertia_2, "inertia I2");
}

}  // namespace mottle::fem::beam
