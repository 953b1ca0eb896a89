#include "mottle/fem/elements/tapered_beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

BeamGeometry slanted() {
  return {.nodes = {Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(2.5, 1.0, 4.0)},
          .offsets = {Eigen::Vector3d(0.1, -0.2, 0.3), Eigen::Vector3d(-0.2, 0.1, 0.2)},
          .orientation = {0.3, 0.2, -1.0},
          .pins = {Components{0}, Components{1 << 5}}};
}

BeamGeometry along_x(double length) {
  BeamGeometry geometry;
  geometry.nodes[1].x() = length;
  geometry.orientation = Eigen::Vector3d::UnitY();
  return geometry;
}

const BeamSection k_section = {
    .area = 2.0, .inertia_1 = 0.5, .inertia_2 = 0.3, .inertia_12 = 0.1, .torsion = 0.4, .shear_1 = 0.8, .shear_2 = 0.7};

/// Numbers at end B over those at end A: a linear taper.
std::vector<BeamSectionAt> taper(double ratio) {
  BeamSection end = k_section;
  for (double* number : {&end.area, &end.inertia_1, &end.inertia_2, &end.inertia_12, &end.torsion}) *number *= ratio;
  return {{0.0, k_section}, {1.0, end}};
}

TEST(TaperedBeam, IsThePrismaticBeamWithAConstantSection) {
  const BeamGeometry geometry = slanted();
  const std::vector<BeamPiece> tapered = tapered_beam_stiffness(geometry, taper(1.0), 2.6);
  const std::vector<BeamPiece> pieces = beam_stiffness(geometry, k_section, 2.6);
  ASSERT_EQ(pieces.size(), 3U);
  const BeamMatrix young = k_section.area * pieces[0].matrix + pieces[2].matrix;
  // 1e-13: a hundred roundings.
  EXPECT_LT((tapered[0].matrix - young).norm(), 1e-12 * young.norm());
  EXPECT_LT((tapered[1].matrix - k_section.torsion * pieces[1].matrix).norm(), 1e-12 * pieces[1].matrix.norm());
  const std::vector<LineWeight> uniform = {{0.0, 1.0}, {0.3, 1.0}, {1.0, 1.0}};
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const BeamMass found = tapered_beam_mass(geometry, uniform, kind), expected = beam_mass(geometry, kind);
    EXPECT_LT((found.line - expected.line).norm(), 1e-10 * expected.line.norm());
    EXPECT_LT((found.torsional - expected.torsional).norm(), 1e-12 * expected.torsional.norm());
  }
}

// Numbers fall linearly to (1 - c): integrals of 1 / (1 - c s) and (1 - s)^2 / (1 - c s), s from 0 to 1, in closed
// form.
TEST(TaperedBeam, DeflectsAsTheClosedFormOfALinearTaper) {
  const double length = 3.0;
  for (const double ratio : {0.9, 0.5, 0.1}) {
    const double c = 1.0 - ratio, log = std::log(1.0 / ratio);
    std::vector<BeamSectionAt> sections = taper(ratio);
    for (BeamSectionAt& at : sections) at.section.inertia_12 = at.section.shear_1 = at.section.shear_2 = 0.0;
    const auto pieces = tapered_beam_stiffness(along_x(length), sections, 2.6);
    EXPECT_NEAR(1.0 / pieces[0].matrix(6, 6), length / 2.0 * log / c, 1e-7);
    EXPECT_NEAR(1.0 / pieces[1].matrix(9, 9), length / 0.4 * log / c, 1e-7 * length / 0.4);
    const Eigen::Matrix<double, 6, 6> tip = pieces[0].matrix.bottomRightCorner<6, 6>();
    const std::vector<int> plane = {1, 5};
    const Eigen::Matrix2d flexibility = Eigen::Matrix2d(tip(plane, plane)).inverse();
    const double integral = 1.0 / (2.0 * c) - ratio / (c * c) + ratio * ratio / (c * c * c) * log;
    EXPECT_NEAR(flexibility(0, 0) / (std::pow(length, 3) / 0.5 * integral), 1.0, 1e-7) << ratio;
    EXPECT_NEAR(flexibility(1, 1) / (length / 0.5 * log / c), 1.0, 1e-7) << ratio;
  }
}

TEST(TaperedBeam, ResistsNoRigidMotion) {
  BeamGeometry geometry = slanted();
  Eigen::Matrix<double, 12, 6> motions;
  for (int end = 0; end < 2; ++end) {
    motions.block<6, 6>(6 * end, 0).setIdentity();
    for (int axis = 0; axis < 3; ++axis)
      motions.block<3, 1>(6 * end, 3 + axis) =
          Eigen::Vector3d::Unit(axis).cross(geometry.nodes[static_cast<std::size_t>(end)]);
  }
  for (const BeamPiece& piece : tapered_beam_stiffness(geometry, taper(0.3), 2.6))
    EXPECT_LT((piece.matrix * motions).norm(), 1e-12 * piece.matrix.norm());
}

// Weight falling from 2 to 1 over the length 3: mass 4.5, its centre at L/3 (a + 2 b) / (a + b) = 4/3.
TEST(TaperedBeamMass, HasTheTotalAndTheCentreOfItsWeight) {
  const std::vector<LineWeight> weights = {{0.0, 2.0}, {1.0, 1.0}};
  Eigen::Matrix<double, 12, 1> lift = Eigen::Matrix<double, 12, 1>::Zero(), turn = lift;
  lift(2) = lift(8) = 1.0;
  turn(8) = -3.0;
  turn(4) = turn(10) = 1.0;  // about y at end A: w = -x
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const BeamMatrix mass = tapered_beam_mass(along_x(3.0), weights, kind).line;
    EXPECT_NEAR(lift.dot(mass * lift), 4.5, 1e-10);
    EXPECT_NEAR(lift.dot(mass * turn), -4.5 * 4.0 / 3.0, 1e-10);
  }
}

TEST(TaperedBeam, RefusesSectionsThatVanish) {
  const auto refusal = [](const std::vector<BeamSectionAt>& sections) {
    return test::message_of<InvalidInput>([&] { tapered_beam_stiffness(along_x(1.0), sections, 2.6); });
  };
  std::vector<BeamSectionAt> sections = taper(0.5);
  sections[1].section.inertia_12 = sections[1].section.inertia_2 = 0.0;
  EXPECT_THAT(refusal(sections), ::testing::HasSubstr("tapered beam: at 1 of the length A is 1, I1 0.25 and I2 0"));
  sections = taper(0.5);
  sections[1].section.torsion = 0.0;
  EXPECT_THAT(refusal(sections), ::testing::HasSubstr("J is zero at some places"));
  sections.pop_back();
  EXPECT_THAT(refusal(sections), ::testing::HasSubstr("sections at both ends"));
}

}  // namespace
}  // namespace mottle::fem
