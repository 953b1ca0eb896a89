#include "mottle/fem/assembly/mass_spring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/message_of.hpp"

namespace mottle::fem {
namespace {

using ::testing::HasSubstr;

MassSpringSystem two_masses() {
  return {.masses = {{"m1", 1.0}, {"m2", 2.0}},
          .springs = {{"k1", k_ground, 0, 1.0}, {"k2", 0, 1, 1.0}},
          .dampers = {{"c1", k_ground, 1, 0.1}}};
}

std::string refusal(const std::function<void(MassSpringSystem&)>& change) {
  MassSpringSystem system = two_masses();
  change(system);
  return test::message_of<InvalidInput>([&] { system.validate(); });
}

TEST(UnitConnector, BetweenTwoMassesResistsTheirRelativeMotion) {
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(3, 3) << 1, 0, -1, 0, 0, 0, -1, 0, 1).finished();
  EXPECT_EQ(unit_connector_matrix({.name = "k", .first = 0, .second = 2}, 3), expected);
}

TEST(UnitConnector, ToGroundResistsTheMotionOfItsMassAlone) {
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(2, 2) << 0, 0, 0, 1).finished();
  EXPECT_EQ(unit_connector_matrix({.name = "k", .first = k_ground, .second = 1}, 2), expected);
}

TEST(UnitConnector, DoesNotDependOnTheDirectionOfItsEnds) {
  EXPECT_EQ(unit_connector_matrix({.name = "k", .first = 0, .second = 1}, 2),
            unit_connector_matrix({.name = "k", .first = 1, .second = 0}, 2));
  EXPECT_EQ(unit_connector_matrix({.name = "k", .first = 0, .second = k_ground}, 2),
            unit_connector_matrix({.name = "k", .first = k_ground, .second = 0}, 2));
}

TEST(UnitMass, ActsOnItsOwnDegreeOfFreedom) {
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(2, 2) << 0, 0, 0, 1).finished();
  EXPECT_EQ(unit_mass_matrix(1, 2), expected);
}

TEST(MassSpringSystem, AcceptsASoundOne) {
  EXPECT_NO_THROW(two_masses().validate());
}

TEST(MassSpringSystem, AcceptsASpringOfZeroStiffness) {
  EXPECT_EQ(refusal([](MassSpringSystem& system) { system.springs[0].value = 0.0; }), "nothing thrown");
}

TEST(MassSpringSystem, AcceptsASpringAndADamperOfOneName) {
  EXPECT_EQ(refusal([](MassSpringSystem& system) { system.dampers[0].name = "k1"; }), "nothing thrown");
}

TEST(MassSpringSystem, NeedsAMass) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses.clear(); }), HasSubstr("masses: there is none"));
}

TEST(MassSpringSystem, RefusesAMassThatIsNotPositive) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses[1].mass = 0.0; }), HasSubstr("mass 'm2': 0 is not"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses[1].mass = -1.0; }),
              HasSubstr("mass 'm2': -1 is not"));
}

TEST(MassSpringSystem, RefusesAValueThatIsNotFinite) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses[0].mass = k_infinity; }),
              HasSubstr("mass 'm1': inf"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.springs[0].value = k_nan; }),
              HasSubstr("spring 'k1': nan"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.dampers[0].value = k_infinity; }),
              HasSubstr("damper 'c1': inf"));
}

TEST(MassSpringSystem, RefusesANegativeStiffnessOrDamping) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.springs[1].value = -1.0; }), HasSubstr("spring 'k2': -1"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.dampers[0].value = -0.5; }),
              HasSubstr("damper 'c1': -0.5"));
}

TEST(MassSpringSystem, RefusesARepeatedName) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses[1].name = "m1"; }),
              HasSubstr("mass 'm1': the name"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.springs[1].name = "k1"; }),
              HasSubstr("spring 'k1': the name is used twice"));
}

TEST(MassSpringSystem, RefusesAMissingName) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses[0].name = ""; }), HasSubstr("a name is missing"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.dampers[0].name = ""; }), HasSubstr("a name is missing"));
}

TEST(MassSpringSystem, KeepsTheNameOfTheGroundForTheGround) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.masses[0].name = "ground"; }), HasSubstr("fixed point"));
}

TEST(MassSpringSystem, RefusesAConnectorOnAMassThatIsNotThere) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.springs[0].second = 2; }),
              HasSubstr("spring 'k1': it ends on a mass that is not there"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.dampers[0].first = -2; }),
              HasSubstr("damper 'c1': it ends on a mass that is not there"));
}

TEST(MassSpringSystem, RefusesAConnectorWithBothEndsOnOnePoint) {
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.springs[1].second = 0; }), HasSubstr("acts on nothing"));
  EXPECT_THAT(refusal([](MassSpringSystem& system) { system.springs[0].second = k_ground; }),
              HasSubstr("acts on nothing"));
}

}  // namespace
}  // namespace mottle::fem
