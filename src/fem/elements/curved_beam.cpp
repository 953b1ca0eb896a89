#include "mottle/fem/elements/curved_beam.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "fem/assembly/rigid_motion.hpp"
#include "fem/elements/beam_frame.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix6x12 = Eigen::Matrix<double, 6, 12>;

/// Motion at `to` of a body that moves at `from`; its transpose carries forces back.
Matrix6 carried(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return rigid_motion(Eigen::Matrix3d::Identity(), to - from);
}

/// Section forces N, V1, V2 and moments T, M2, M1 at phi by force and moment at the point `at`.
Matrix6 section_forces(const Arc& arc, double phi, const Eigen::Vector3d& at) {
  const Eigen::Vector3d radial = arc.radial_at(phi);
  Eigen::Matrix3d axes;
  axes << arc.tangent_at(phi).transpose(), radial.transpose(), arc.normal.transpose();
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = axes;
  turn.bottomRightCorner<3, 3>() = axes;
  return turn * carried(arc.point(phi), at).transpose();
}

/// Strains and curvatures of a section by its forces and moments, per unit E.
Matrix6 section_flexibility(const Arc& arc, const CurvedBeamSection& section, double young_over_shear) {
  const auto soft = [&](double factor) { return factor > 0.0 ? young_over_shear / (factor * section.area) : 0.0; };
  Eigen::Matrix<double, 6, 1> diagonal;
  diagonal << 1.0 / section.area, soft(section.shear_1), soft(section.shear_2), young_over_shear / section.torsion,
      1.0 / section.inertia_2, 1.0 / section.inertia_1;
  Matrix6 flexibility = diagonal.asDiagonal();
  flexibility(0, 5) = flexibility(5, 0) = 1.0 / (section.area * arc.radius);
  return flexibility;
}

/// Motion of points along the arc, A clamped, under loads at B.
struct Deflections {
  std::vector<double> phi;
  std::vector<Matrix6> by_loads;  ///< of the point at phi
};

Deflections deflections_of(const Arc& arc, const CurvedBeamSection& section, double young_over_shear) {
  constexpr int k_parts = 64;  // three Gauss points in each: 1e-13 for a quarter of a circle
  const Matrix6 flexibility = section_flexibility(arc, section, young_over_shear);
  const Eigen::Vector3d start = arc.point(0.0), end = arc.point(arc.angle);
  const double half = 0.5 * arc.angle / k_parts, far = std::sqrt(0.6);
  Deflections result{{0.0}, {Matrix6::Zero()}};
  Matrix6 sum = Matrix6::Zero();
  for (int part = 0; part < k_parts; ++part) {
    const double middle = (2 * part + 1) * half;
    for (const int side : {-1, 0, 1}) {
      const double phi = middle + side * far * half, ds = (side == 0 ? 8.0 : 5.0) / 9.0 * half * arc.radius;
      sum += ds * section_forces(arc, phi, start).transpose() * flexibility * section_forces(arc, phi, end);
    }
    result.phi.push_back(middle + half);
    result.by_loads.push_back(carried(start, arc.point(middle + half)) * sum);
  }
  return result;
}

double simpson_weight(std::size_t k, std::size_t last) {
  if (k == 0 || k == last) return 1.0 / 3.0;
  return k % 2 == 1 ? 4.0 / 3.0 : 2.0 / 3.0;
}

/// Adds a mass per unit of mass per length at a point whose motion follows the nodes so.
void add_mass(double length, const Matrix6x12& motion, const Eigen::Vector3d& tangent, CurvedBeamMatrices& result) {
  const Eigen::Matrix<double, 3, 12> moved = motion.topRows<3>();
  const Eigen::Matrix<double, 1, 12> twisted = tangent.transpose() * motion.bottomRows<3>();
  result.line += length * moved.transpose() * moved;
  result.torsional += length * twisted.transpose() * twisted;
}

void require_sound(const CurvedBeamSection& section, double young_over_shear) {
  for (const double number : {section.area, section.inertia_1, section.inertia_2, section.torsion, young_over_shear}) {
    require(std::isfinite(number) && number > 0.0,
            "curved beam: A is {:g}, I1 {:g}, I2 {:g}, J {:g} and E / G {:g}; all must be positive", section.area,
            section.inertia_1, section.inertia_2, section.torsion, young_over_shear);
  }
}

Arc arc_about(const Eigen::Vector3d& center, const std::array<Eigen::Vector3d, 2>& points) {
  const Eigen::Vector3d a = points[0] - center, b = points[1] - center, cross = a.cross(b);
  require(center.allFinite() && cross.norm() > 1e-9 * a.squaredNorm(),
          "curved beam: v gives a straight line or half a circle; an arc between them is needed");
  return {center, a.normalized(), cross.normalized(), a.norm(), std::atan2(cross.norm(), a.dot(b))};
}

}  // namespace

Arc arc_between(const std::array<Eigen::Vector3d, 2>& points, const Eigen::Vector3d& v, ArcRule rule, double number) {
  const std::pair<Eigen::Vector3d, double> axis = beam::axis_of(points[0], points[1]);
  const Eigen::Vector3d& along = axis.first;
  const double chord = axis.second;
  const Eigen::Vector3d across = v - v.dot(along) * along;
  require(across.norm() > 1e-6 * v.norm(), "curved beam: v is zero or parallel to the line between its ends");
  const Eigen::Vector3d out = across.normalized(), middle = 0.5 * (points[0] + points[1]);
  const auto on_line = [&](const Eigen::Vector3d& direction) -> Eigen::Vector3d {
    return points[0] + chord / (2.0 * direction.dot(along)) * direction;  // as far from B as from A
  };
  switch (rule) {
    case ArcRule::center:
      require(std::abs(v.dot(along)) > 1e-6 * v.norm(), "curved beam: v is perpendicular to the line between its ends");
      return arc_about(on_line(v), points);
    case ArcRule::tangent:
      require(v.dot(along) > 1e-6 * v.norm(),
              "curved beam: the tangent v points away from end B, the arc would be half a circle or more");
      return arc_about(on_line(v.dot(along) * out - v.dot(out) * along), points);
    case ArcRule::radius: {
      require(number > 0.5 * chord,
              "curved beam: its radius {:g} is not larger than half the distance of its ends, {:g}", number,
              0.5 * chord);
      return arc_about(middle - std::sqrt(number * number - 0.25 * chord * chord) * out, points);
    }
    case ArcRule::angle:
      break;
  }
  require(number > 0.0 && number < 180.0, "curved beam: its angle is {:g} degrees, it must lie in (0, 180)", number);
  return arc_about(middle - 0.5 * chord / std::tan(number * std::numbers::pi / 360.0) * out, points);
}

CurvedBeamMatrices curved_beam(const Arc& arc, const std::array<Eigen::Vector3d, 2>& nodes,
                               const CurvedBeamSection& section, double young_over_shear, MassKind kind) {
  require_sound(section, young_over_shear);
  const Eigen::Vector3d a = arc.point(0.0), b = arc.point(arc.angle);
  const Deflections deflections = deflections_of(arc, section, young_over_shear);
  Matrix6x12 deformation;  // of B, A clamped, by the nodes
  deformation << -carried(nodes[0], b), carried(nodes[1], b);
  const Matrix6x12 loads = deflections.by_loads.back().inverse() * deformation;
  CurvedBeamMatrices result;
  result.stiffness = beam::symmetric(deformation.transpose() * loads);
  const double length = arc.radius * arc.angle;
  if (kind == MassKind::lumped) {
    Matrix6x12 motion_of_a = Matrix6x12::Zero(), motion_of_b = Matrix6x12::Zero();
    motion_of_a.leftCols<6>() = carried(nodes[0], a);
    motion_of_b.rightCols<6>() = carried(nodes[1], b);
    add_mass(0.5 * length, motion_of_a, arc.tangent_at(0.0), result);
    add_mass(0.5 * length, motion_of_b, arc.tangent_at(arc.angle), result);
  } else {
    const std::size_t last = deflections.phi.size() - 1;
    for (std::size_t k = 0; k <= last; ++k) {
      const double phi = deflections.phi[k];
      Matrix6x12 motion = deflections.by_loads[k] * loads;
      motion.leftCols<6>() += carried(nodes[0], arc.point(phi));
      add_mass(simpson_weight(k, last) * length / static_cast<double>(last), motion, arc.tangent_at(phi), result);
    }
  }
  result.line = beam::symmetric(result.line);
  result.torsional = beam::symmetric(result.torsional);
  return result;
}

}  // namespace mottle::fem
