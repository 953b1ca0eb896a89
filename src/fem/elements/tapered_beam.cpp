#include "mottle/fem/elements/tapered_beam.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "fem/elements/beam_frame.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

/// Calls use(position, weight) for the integration points from `first` to `last`, fractions of the length.
template <typename Use>
void integrate(double first, double last, int parts, const Use& use) {
  const double far = std::sqrt(0.6), half = 0.5 * (last - first) / parts;
  for (int part = 0; part < parts; ++part) {
    const double middle = first + (2 * part + 1) * half;
    use(middle - far * half, 5.0 / 9.0 * half);
    use(middle, 8.0 / 9.0 * half);
    use(middle + far * half, 5.0 / 9.0 * half);
  }
}

BeamSection between(const BeamSectionAt& a, const BeamSectionAt& b, double position) {
  const double t = (position - a.position) / (b.position - a.position);
  const auto mix = [&](double BeamSection::*number) { return (1.0 - t) * a.section.*number + t * (b.section.*number); };
  return {.area = mix(&BeamSection::area),
          .inertia_1 = mix(&BeamSection::inertia_1),
          .inertia_2 = mix(&BeamSection::inertia_2),
          .inertia_12 = mix(&BeamSection::inertia_12),
          .torsion = mix(&BeamSection::torsion),
          .shear_1 = mix(&BeamSection::shear_1),
          .shear_2 = mix(&BeamSection::shear_2)};
}

void require_sound(std::span<const BeamSectionAt> sections, double young_over_shear) {
  const bool has_torsion = sections.front().section.torsion > 0.0;
  for (const BeamSectionAt& at : sections) {
    beam::require_sound(at.section, young_over_shear);
    require(at.section.area > 0.0 && at.section.inertia_1 > 0.0 && at.section.inertia_2 > 0.0,
            "tapered beam: at {:g} of the length A is {:g}, I1 {:g} and I2 {:g}; all must be positive", at.position,
            at.section.area, at.section.inertia_1, at.section.inertia_2);
    require((at.section.torsion > 0.0) == has_torsion,
            "tapered beam: J is zero at some places and not at others; give it everywhere or nowhere");
  }
}

/// Flexibilities of a bar clamped at A, per unit E and G.
struct Flexibility {
  double axial = 0.0, twist = 0.0;
  Eigen::Matrix4d bending = Eigen::Matrix4d::Zero();  ///< deflections and slopes by forces and moments at B
};

Flexibility flexibility_of(double length, std::span<const BeamSectionAt> sections, double young_over_shear) {
  Flexibility sum;
  const auto add = [&](const BeamSection& section, double position, double dx) {
    const auto soft = [&](double factor) { return factor > 0.0 ? young_over_shear / (factor * section.area) : 0.0; };
    const Eigen::Matrix2d inertia{{section.inertia_1, section.inertia_12}, {section.inertia_12, section.inertia_2}};
    const Eigen::Matrix2d bent = dx * inertia.inverse();
    const double lever = length * (1.0 - position);
    sum.axial += dx / section.area;
    if (section.torsion > 0.0) sum.twist += dx / section.torsion;
    sum.bending.topLeftCorner<2, 2>() += lever * lever * bent;
    sum.bending.topLeftCorner<2, 2>().diagonal() += dx * Eigen::Vector2d(soft(section.shear_1), soft(section.shear_2));
    sum.bending.topRightCorner<2, 2>() += lever * bent;
    sum.bending.bottomLeftCorner<2, 2>() += lever * bent;
    sum.bending.bottomRightCorner<2, 2>() += bent;
  };
  constexpr int k_parts = 32;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const BeamSectionAt &a = sections[i - 1], &b = sections[i];
    integrate(a.position, b.position, k_parts,
              [&](double position, double weight) { add(between(a, b, position), position, weight * length); });
  }
  return sum;
}

/// Cubic shape functions of the deflection in a plane: of A, of its slope, of B, of its slope.
Eigen::Vector4d cubic(double t, double length) {
  const double t2 = t * t, t3 = t2 * t;
  return {1.0 - 3.0 * t2 + 2.0 * t3, length * (t - 2.0 * t2 + t3), 3.0 * t2 - 2.0 * t3, length * (t3 - t2)};
}

/// Adds the mass dm at t, in both planes.
void add_deflections(double t, double length, double dm, BeamMatrix& line) {
  constexpr std::array<Eigen::Index, 2> k_deflection = {1, 2}, k_rotation = {5, 4};
  for (std::size_t plane = 0; plane < 2; ++plane) {
    const double sign = plane == 0 ? 1.0 : -1.0;  // slope w' = -rotation y
    const Eigen::Vector4d shape = cubic(t, length).cwiseProduct(Eigen::Vector4d(1.0, sign, 1.0, sign));
    const Eigen::Index v = k_deflection[plane], r = k_rotation[plane];
    const std::array<Eigen::Index, 4> rows = {v, r, 6 + v, 6 + r};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j)
        line(rows[i], rows[j]) += dm * shape(static_cast<Eigen::Index>(i)) * shape(static_cast<Eigen::Index>(j));
    }
  }
}

/// Adds the mass dm at t in one component that varies linearly, half of it lumped.
void add_linear(Eigen::Index component, double t, double dm, double consistent, BeamMatrix& mass) {
  const std::array<double, 2> shape = {1.0 - t, t};
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double own = shape[static_cast<std::size_t>(i)];
    mass(6 * i + component, 6 * i + component) += (1.0 - consistent) * dm * own;
    for (Eigen::Index j = 0; j < 2; ++j)
      mass(6 * i + component, 6 * j + component) += consistent * dm * own * shape[static_cast<std::size_t>(j)];
  }
}

}  // namespace

std::vector<BeamPiece> tapered_beam_stiffness(const BeamGeometry& geometry, std::span<const BeamSectionAt> sections,
                                              double young_over_shear) {
  require(sections.size() >= 2 && sections.front().position == 0.0 && sections.back().position == 1.0,
          "tapered beam: sections at both ends are needed");
  require_sound(sections, young_over_shear);
  beam::require_stiffness_at_pins(geometry.pins, sections.front().section);
  const beam::Frame frame = beam::frame_of(geometry);
  const Flexibility flexibility = flexibility_of(frame.length, sections, young_over_shear);
  BeamMatrix axial = beam::two_ends(0, 1.0 / flexibility.axial, -1.0 / flexibility.axial);
  beam::release(geometry.pins, beam::k_axial, axial);
  const Eigen::Matrix<double, 4, 12> deformed = beam::deformation(frame.length);
  BeamMatrix bending = beam::symmetric(deformed.transpose() * flexibility.bending.inverse() * deformed);
  beam::release(geometry.pins, beam::k_plane_1 | beam::k_plane_2, bending);
  BeamMatrix twist = BeamMatrix::Zero();
  if (flexibility.twist > 0.0) twist = beam::two_ends(3, 1.0 / flexibility.twist, -1.0 / flexibility.twist);
  beam::release(geometry.pins, beam::k_twist, twist);
  return {{BeamCoefficient::E, beam::to_basic(frame, axial + bending)},
          {BeamCoefficient::G, beam::to_basic(frame, twist)}};
}

BeamMass tapered_beam_mass(const BeamGeometry& geometry, std::span<const LineWeight> weights, MassKind kind) {
  const beam::Frame frame = beam::frame_of(geometry);
  const double length = frame.length, consistent = kind == MassKind::lumped ? 0.0 : 0.5;
  BeamMatrix line = BeamMatrix::Zero(), torsional = BeamMatrix::Zero();
  for (std::size_t i = 1; i < weights.size(); ++i) {
    const LineWeight &a = weights[i - 1], &b = weights[i];
    // Of degree seven, of which three points take five exactly: 16 parts leave 1e-12.
    integrate(a.position, b.position, 16, [&](double t, double fraction) {
      const double along = (t - a.position) / (b.position - a.position);
      const double dm = fraction * length * ((1.0 - along) * a.weight + along * b.weight);
      add_linear(0, t, dm, consistent, line);
      add_linear(3, t, dm, consistent, torsional);
      if (kind == MassKind::consistent) return add_deflections(t, length, dm, line);
      add_linear(1, t, dm, 0.0, line);
      add_linear(2, t, dm, 0.0, line);
    });
  }
  if (kind == MassKind::consistent) beam::release_mass(geometry, length, line, torsional);
  return {.line = beam::to_basic(frame, line), .torsional = beam::to_basic(frame, torsional)};
}

}  // namespace mottle::fem
