#include "mottle/fem/elements/beam.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "fem/assembly/rigid_motion.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

constexpr Components bit(Eigen::Index component) {
  return static_cast<Components>(1u << component);
}
constexpr Components k_axial = bit(0), k_twist = bit(3);
constexpr Components k_plane_1 = bit(1) | bit(5), k_plane_2 = bit(2) | bit(4);

struct BeamFrame {
  double length = 0.0;
  BeamMatrix to_local = BeamMatrix::Zero();  ///< from the nodes in basic coordinates to the ends in element axes
};

BeamMatrix symmetric(BeamMatrix matrix) {
  matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
  return matrix;
}

BeamMatrix to_basic(const BeamFrame& frame, const BeamMatrix& local) {
  return symmetric(frame.to_local.transpose() * local * frame.to_local);
}

/// Axis of a bar and its length, after the check that it has one.
std::pair<Vector3, double> axis_of(const Vector3& a, const Vector3& b) {
  require(a.allFinite() && b.allFinite(), "beam: a coordinate is not a finite number");
  const double length = (b - a).norm();
  // Below this the direction is made of rounding errors of the coordinates.
  require(length > 1e-12 * std::max(a.norm(), b.norm()),
          "beam: both ends lie at ({:g}, {:g}, {:g}), two different points are needed", a.x(), a.y(), a.z());
  return {(b - a) / length, length};
}

BeamFrame frame_of(const BeamGeometry& geometry) {
  const Vector3 a = geometry.nodes[0] + geometry.offsets[0], b = geometry.nodes[1] + geometry.offsets[1];
  const auto [x, length] = axis_of(a, b);
  const Vector3 normal = x.cross(geometry.orientation);
  require(normal.norm() > 1e-6 * geometry.orientation.norm(),
          "beam: the orientation ({:g}, {:g}, {:g}) runs along the axis, a direction across it is needed",
          geometry.orientation.x(), geometry.orientation.y(), geometry.orientation.z());
  Matrix3 axes;
  axes.row(0) = x;
  axes.row(2) = normal.normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  BeamFrame frame{.length = length};
  for (Eigen::Index end = 0; end < 2; ++end) {
    frame.to_local.block<3, 3>(6 * end, 6 * end) = axes;
    frame.to_local.block<3, 3>(6 * end + 3, 6 * end + 3) = axes;
    frame.to_local.block<3, 3>(6 * end, 6 * end + 3) = -axes * cross_matrix(geometry.offsets[end]);
  }
  return frame;
}

/// [[ends, far], [far, ends]] in one component.
BeamMatrix two_ends(Eigen::Index component, double ends, double far) {
  BeamMatrix matrix = BeamMatrix::Zero();
  matrix(component, component) = matrix(6 + component, 6 + component) = ends;
  matrix(component, 6 + component) = matrix(6 + component, component) = far;
  return matrix;
}

/// Local bending stiffness of both planes per unit E, exact for end loads.
/// @param inertia  [[I1, I12], [I12, I2]]
/// @param shear    E / (K A G) of both planes; 0: rigid
BeamMatrix bending(double length, const Eigen::Matrix2d& inertia, const Eigen::Vector2d& shear) {
  // Deformations of a bar clamped at A: deflection and slope of B. Slopes v' = rotation z, w' = -rotation y make both
  // planes alike. Their stiffness inverts the flexibility (L^3/3 I^-1 + L shear, L^2/2 I^-1; ., L I^-1), here without
  // I^-1, for a plane may have no inertia.
  const Eigen::Matrix2d phi = 12.0 / (length * length) * Eigen::Matrix2d(shear.asDiagonal());
  const Eigen::Matrix2d softened = (Eigen::Matrix2d::Identity() + inertia * phi).inverse() * inertia;
  const Eigen::Matrix2d q = 12.0 / (length * length * length) * softened;
  Eigen::Matrix4d stiffness;
  stiffness << q, -0.5 * length * q, -0.5 * length * q, inertia / length + 0.25 * length * length * q;
  Eigen::Matrix<double, 4, 12> deformation = Eigen::Matrix<double, 4, 12>::Zero();
  constexpr std::array<Eigen::Index, 2> deflection = {1, 2}, rotation = {5, 4};
  constexpr std::array<double, 2> slope = {1.0, -1.0};
  for (Eigen::Index plane = 0; plane < 2; ++plane) {
    deformation(plane, deflection[plane]) = -1.0;
    deformation(plane, 6 + deflection[plane]) = 1.0;
    deformation(plane, rotation[plane]) = -length * slope[plane];
    deformation(2 + plane, rotation[plane]) = -slope[plane];
    deformation(2 + plane, 6 + rotation[plane]) = slope[plane];
  }
  return symmetric(deformation.transpose() * stiffness * deformation);
}

/// Condenses the pinned ones among `components` out of a local stiffness, and applies the same reduction to `mass`.
void release(const std::array<Components, 2>& pins, Components components, BeamMatrix& stiffness,
             BeamMatrix* mass = nullptr) {
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

void require_sound(const BeamSection& section, double young_over_shear) {
  for (const double number :
       {section.area, section.inertia_1, section.inertia_2, section.torsion, section.shear_1, section.shear_2}) {
    require(std::isfinite(number) && number >= 0.0, "beam section: {:g} is not allowed, a number >= 0 is needed",
            number);
  }
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

/// As Nastran: a released component must have stiffness.
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

BeamPiece piece(BeamCoefficient coefficient, const BeamFrame& frame, const std::array<Components, 2>& pins,
                Components components, BeamMatrix local) {
  release(pins, components, local);
  return {coefficient, to_basic(frame, local)};
}

}  // namespace

std::vector<BeamPiece> beam_stiffness(const BeamGeometry& geometry, const BeamSection& section,
                                      double young_over_shear) {
  require_sound(section, young_over_shear);
  require_stiffness_at_pins(geometry.pins, section);
  const BeamFrame frame = frame_of(geometry);
  const double length = frame.length;
  const std::array<Components, 2>& pins = geometry.pins;
  using enum BeamCoefficient;
  std::vector<BeamPiece> pieces = {
      piece(EA, frame, pins, k_axial, two_ends(0, 1.0 / length, -1.0 / length)),
      piece(GJ, frame, pins, k_twist, two_ends(3, 1.0 / length, -1.0 / length)),
  };
  const Components both_planes = k_plane_1 | k_plane_2;
  const bool is_pinned = ((pins[0] | pins[1]) & both_planes) != 0;
  const bool is_flexible_in_shear = section.shear_1 > 0.0 || section.shear_2 > 0.0;
  if (is_flexible_in_shear || (is_pinned && section.inertia_12 != 0.0)) {
    const auto flexibility = [&](double factor) {
      return factor > 0.0 ? young_over_shear / (factor * section.area) : 0.0;
    };
    const Eigen::Matrix2d inertia{{section.inertia_1, section.inertia_12}, {section.inertia_12, section.inertia_2}};
    pieces.push_back(piece(E, frame, pins, both_planes,
                           bending(length, inertia, {flexibility(section.shear_1), flexibility(section.shear_2)})));
    return pieces;
  }
  const Eigen::Vector2d rigid = Eigen::Vector2d::Zero();
  pieces.push_back(piece(EI1, frame, pins, k_plane_1, bending(length, Eigen::Vector2d(1.0, 0.0).asDiagonal(), rigid)));
  pieces.push_back(piece(EI2, frame, pins, k_plane_2, bending(length, Eigen::Vector2d(0.0, 1.0).asDiagonal(), rigid)));
  if (section.inertia_12 != 0.0) {
    const Eigen::Matrix2d coupling{{0.0, 1.0}, {1.0, 0.0}};
    pieces.push_back(piece(EI12, frame, pins, 0, bending(length, coupling, rigid)));
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

BeamMass beam_mass(const BeamGeometry& geometry, MassKind kind) {
  const BeamFrame frame = frame_of(geometry);
  const double length = frame.length;
  BeamMatrix line = BeamMatrix::Zero(), torsional = BeamMatrix::Zero();
  if (kind == MassKind::lumped) {
    for (Eigen::Index component = 0; component < 3; ++component) line += two_ends(component, 0.5 * length, 0.0);
    torsional = two_ends(3, 0.5 * length, 0.0);
  } else {
    line = two_ends(0, 5.0 / 12.0 * length, length / 12.0) + cubic_mass(length);
    torsional = two_ends(3, 5.0 / 12.0 * length, length / 12.0);
    BeamMatrix axial = two_ends(0, 1.0, -1.0), twist = two_ends(3, 1.0, -1.0);
    BeamMatrix bent = bending(length, Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero());
    release(geometry.pins, k_axial, axial, &line);
    release(geometry.pins, k_twist, twist, &torsional);
    release(geometry.pins, k_plane_1 | k_plane_2, bent, &line);
  }
  return {.line = to_basic(frame, line), .torsional = to_basic(frame, torsional)};
}

std::array<BeamPiece, 2> rod_stiffness(const std::array<Eigen::Vector3d, 2>& nodes) {
  const auto [axis, length] = axis_of(nodes[0], nodes[1]);
  const Matrix3 block = axis * axis.transpose() / length;
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
  const auto [axis, length] = axis_of(nodes[0], nodes[1]);
  BeamMatrix mass = BeamMatrix::Zero();
  for (Eigen::Index component = 0; component < 3; ++component) mass += two_ends(component, 0.5 * length, 0.0);
  if (kind == MassKind::lumped) return mass;
  const Matrix3 shared = length / 12.0 * axis * axis.transpose();
  for (Eigen::Index first = 0; first < 2; ++first) {
    for (Eigen::Index second = 0; second < 2; ++second) {
      mass.block<3, 3>(6 * first, 6 * second) += (first == second ? -1.0 : 1.0) * shared;
    }
  }
  return symmetric(mass);
}

}  // namespace mottle::fem
