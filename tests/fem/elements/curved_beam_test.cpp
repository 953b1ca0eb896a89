#include "mottle/fem/elements/curved_beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using std::numbers::pi;
using test::dense;
using ::testing::HasSubstr;

constexpr double k_radius = 2.0, k_young_over_shear = 2.6;
const CurvedBeamSection k_section = {
    .area = 0.5, .inertia_1 = 0.02, .inertia_2 = 0.03, .torsion = 0.04, .shear_1 = 0.8, .shear_2 = 0.7};

/// From (R, 0, 0) to (0, R, 0) about the origin.
const std::array<Eigen::Vector3d, 2> k_quarter = {Eigen::Vector3d(k_radius, 0, 0), Eigen::Vector3d(0, k_radius, 0)};

Arc quarter() {
  return arc_between(k_quarter, -Eigen::Vector3d::UnitX(), ArcRule::center, 0.0);
}

CurvedBeamMatrices quarter_beam(MassKind kind = MassKind::consistent) {
  return curved_beam(quarter(), k_quarter, k_section, k_young_over_shear, kind);
}

/// Displacement of end B under a force there, end A clamped, E = 1.
Eigen::Matrix<double, 6, 1> tip(int component) {
  const BeamMatrix K = quarter_beam().stiffness;
  return K.bottomRightCorner<6, 6>().ldlt().solve(Eigen::Matrix<double, 6, 1>::Unit(component));
}

// Castigliano with M = R (1 - sin), N = sin, V = cos: bending, tension, shear and their coupling 2 M N / (E A R).
TEST(CurvedBeam, BendsInItsPlaneAsTheClosedForm) {
  const double r = k_radius, a = k_section.area;
  EXPECT_NEAR(tip(0)(0),
              r * r * r / k_section.inertia_1 * (0.75 * pi - 2.0) + 0.25 * pi * r / a +
                  0.25 * pi * r * k_young_over_shear / (0.8 * a) + 2.0 * r / a * (1.0 - 0.25 * pi),
              1e-10);
}

// M2 = R cos, T = R (1 - sin), V2 = 1.
TEST(CurvedBeam, BendsAndTwistsAcrossItsPlaneAsTheClosedForm) {
  const double r = k_radius;
  EXPECT_NEAR(
      tip(2)(2),
      r * r * r * (0.25 * pi / k_section.inertia_2 + (0.75 * pi - 2.0) * k_young_over_shear / k_section.torsion) +
          0.5 * pi * r * k_young_over_shear / (0.7 * k_section.area),
      1e-10);
}

TEST(CurvedBeam, ResistsNoRigidMotionAndHasTheInertiaOfItsLine) {
  const CurvedBeamMatrices beam = quarter_beam();
  Eigen::Matrix<double, 12, 6> rigid;
  for (int end = 0; end < 2; ++end) {
    const Eigen::Vector3d& x = k_quarter[static_cast<std::size_t>(end)];
    rigid.middleRows<6>(6 * end).setIdentity();
    rigid.block<3, 3>(6 * end, 3) << 0, x.z(), -x.y(), -x.z(), 0, x.x(), x.y(), -x.x(), 0;
  }
  EXPECT_LT((beam.stiffness * rigid).cwiseAbs().maxCoeff(), 1e-12 * beam.stiffness.maxCoeff());
  const Eigen::Matrix<double, 6, 6> inertia = rigid.transpose() * beam.line * rigid;
  const double length = 0.5 * pi * k_radius, r2 = k_radius * k_radius;
  EXPECT_NEAR(inertia(0, 0), length, 1e-7);               // Simpson: h^4
  EXPECT_NEAR(inertia(1, 5), k_radius * k_radius, 1e-7);  // m x of the centre of gravity = R^2
  EXPECT_NEAR(inertia(5, 5), length * r2, 1e-7);          // about z
  EXPECT_NEAR(inertia(3, 3), 0.5 * length * r2, 1e-7);    // about x
}

TEST(CurvedBeam, LumpedIsHalfAtEachEnd) {
  const BeamMatrix line = quarter_beam(MassKind::lumped).line;
  const double half = 0.25 * pi * k_radius;
  EXPECT_NEAR(line(0, 0), half, 1e-14);
  EXPECT_NEAR(line(8, 8), half, 1e-14);
  EXPECT_NEAR(line.trace(), 6.0 * half, 1e-14);
}

// With a radius of 1000 lengths it is the straight beam, up to the rise of the arc.
TEST(CurvedBeam, IsAStraightBeamWhereItsRadiusIsLarge) {
  const std::array<Eigen::Vector3d, 2> ends = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0)};
  const Arc arc = arc_between(ends, Eigen::Vector3d::UnitY(), ArcRule::radius, 1e5);
  const BeamMatrix found = curved_beam(arc, ends, k_section, k_young_over_shear, MassKind::consistent).stiffness;
  BeamGeometry geometry{.nodes = ends, .orientation = Eigen::Vector3d::UnitY()};
  const BeamSection section{
      .area = 0.5, .inertia_1 = 0.02, .inertia_2 = 0.03, .torsion = 0.04, .shear_1 = 0.8, .shear_2 = 0.7};
  BeamMatrix expected = BeamMatrix::Zero();
  for (const BeamPiece& piece : beam_stiffness(geometry, section, k_young_over_shear)) {
    const double factor = piece.coefficient == BeamCoefficient::EA   ? section.area
                          : piece.coefficient == BeamCoefficient::GJ ? section.torsion / k_young_over_shear
                                                                     : 1.0;
    expected += factor * piece.matrix;
  }
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 2e-5 * expected.maxCoeff());
}

TEST(CurvedBeamArc, IsTheSameByEveryRule) {
  const Eigen::Vector3d out = (k_quarter[0] + k_quarter[1]) + Eigen::Vector3d(0.3, -0.3, 0.0);
  for (const Arc& arc :
       {quarter(), arc_between(k_quarter, Eigen::Vector3d::UnitX(), ArcRule::center, 0.0),
        arc_between(k_quarter, Eigen::Vector3d::UnitY(), ArcRule::tangent, 0.0),
        arc_between(k_quarter, out, ArcRule::radius, k_radius), arc_between(k_quarter, out, ArcRule::angle, 90.0)}) {
    EXPECT_LT(arc.center.norm(), 1e-14);
    EXPECT_NEAR(arc.radius, k_radius, 1e-14);
    EXPECT_NEAR(arc.angle, 0.5 * pi, 1e-14);
    EXPECT_LT((arc.normal - Eigen::Vector3d::UnitZ()).norm(), 1e-14);
  }
}

TEST(CurvedBeamArc, RefusesVectorsAndNumbersThatGiveNone) {
  const auto message = [](const Eigen::Vector3d& v, ArcRule rule, double number = 0.0) {
    return test::message_of<InvalidInput>([&] { arc_between(k_quarter, v, rule, number); });
  };
  EXPECT_THAT(message({-1, 1, 0}, ArcRule::center), HasSubstr("v is zero or parallel"));
  EXPECT_THAT(message({1, 1, 0}, ArcRule::center), HasSubstr("v is perpendicular"));
  EXPECT_THAT(message({0, -1, 0}, ArcRule::tangent), HasSubstr("points away from end B"));
  EXPECT_THAT(message({1, 1, 0}, ArcRule::radius, 1.0), HasSubstr("is not larger than half the distance"));
  EXPECT_THAT(message({1, 1, 0}, ArcRule::angle, 180.0), HasSubstr("must lie in (0, 180)"));
}

/// A thin ring of radius 1 of n elements, E = 1000, rho = 1, with a square section of edge h, G J = 0.14 E h^4 / 2.6.
test::ModelMaker ring(int n, double h) {
  test::ModelMaker maker;
  const int metal = maker.material(1, 1000.0, 0.3, 1.0);
  const double inertia = h * h * h * h / 12.0;
  const CurvedBeamElement property{.material = metal,
                                   .area = maker.field("PBEND", 1, "A", h * h),
                                   .inertia_1 = maker.field("PBEND", 1, "I1", inertia),
                                   .inertia_2 = maker.field("PBEND", 1, "I2", inertia),
                                   .torsion = maker.field("PBEND", 1, "J", 1.69 * inertia),
                                   .radius = 1.0,
                                   .rule = ArcRule::radius};
  for (int k = 0; k < n; ++k) maker.node(k + 1, {std::cos(2.0 * pi * k / n), std::sin(2.0 * pi * k / n), 0.0});
  for (int k = 0; k < n; ++k) {
    CurvedBeamElement beam = property;
    beam.id = k + 1;
    beam.nodes = {k, (k + 1) % n};
    const double middle = 2.0 * pi * (k + 0.5) / n;
    beam.orientation = {std::cos(middle), std::sin(middle), 0.0};
    maker.model.elements<CurvedBeamElement>().push_back(beam);
  }
  maker.model.settings.coupled_mass = true;
  return maker;
}

/// Squares of the circular frequencies that are not of rigid motions.
Eigen::VectorXd elastic_eigenvalues(const FiniteElementModel& model) {
  const AssembledModel assembled = assemble(model, {});
  const Eigen::MatrixXd K = dense(assembled.stiffness.at(Eigen::VectorXd())),
                        M = dense(assembled.mass.at(Eigen::VectorXd()));
  const Eigen::VectorXd values = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M).eigenvalues();
  return values.tail(values.size() - 6);
}

// In its plane w^2 = E I / (rho A R^4) n^2 (n^2 - 1)^2 / (n^2 + 1), across it the same with n^2 + E I / G J
// [Blevins1979], for an inextensible ring without rotary inertia: both leave out (h / R)^2 = 1e-6. The mass of 16 arcs
// a wave leaves 3e-5.
TEST(CurvedBeamRing, HasTheFrequenciesOfTheClosedForm) {
  const double h = 1e-3, unit = 1000.0 * h * h / 12.0;
  const Eigen::VectorXd values = elastic_eigenvalues(ring(48, h).model);
  for (int n = 2; n <= 3; ++n) {
    const double n2 = n * n, top = n2 * (n2 - 1.0) * (n2 - 1.0) * unit;
    const double across = top / (n2 + 2.6 / 1.69), within = top / (n2 + 1.0);
    const Eigen::Index first = 4 * (n - 2);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(values(first + k) / across, 1.0, 1e-4) << n;
      EXPECT_NEAR(values(first + 2 + k) / within, 1.0, 1e-4) << n;
    }
  }
}

/// The same ring of straight beams.
FiniteElementModel polygon(int n, double h) {
  test::ModelMaker maker = ring(n, h);
  maker.model.elements<CurvedBeamElement>().clear();
  const double inertia = h * h * h * h / 12.0;
  const int section = maker.beam_property(1, 0, h * h, inertia, inertia, 1.69 * inertia);
  for (int k = 0; k < n; ++k) maker.beam(k + 1, k, (k + 1) % n, section, Eigen::Vector3d::UnitZ());
  return maker.model;
}

// A polygon converges with the square of its edge; 16 arcs are closer than 64 edges.
TEST(CurvedBeamRing, IsWhatPolygonsConvergeTo) {
  const double h = 1e-2;
  const double arcs = elastic_eigenvalues(ring(48, h).model)(0);
  const double coarse = elastic_eigenvalues(polygon(32, h))(0) / arcs - 1.0,
               fine = elastic_eigenvalues(polygon(64, h))(0) / arcs - 1.0;
  EXPECT_NEAR(coarse / fine, 4.0, 0.3);
  EXPECT_LT(std::abs((4.0 * fine - coarse) / 3.0), 2e-4) << "extrapolated; (h / R)^2 = 1e-4 is left";
  EXPECT_LT(std::abs(elastic_eigenvalues(ring(16, h).model)(0) / arcs - 1.0), std::abs(fine));
}

}  // namespace
}  // namespace mottle::fem
