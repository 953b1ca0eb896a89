#include "mottle/model/structures/affine_matrices.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/message_of.hpp"
#include "model/structures.hpp"

namespace mottle::model {
namespace {

using ::testing::HasSubstr;

/// Two masses with springs and dampers.
MassSpringSystem damped_system() {
  MassSpringSystem system = test::two_mass_system(1.0, 2.0, 0.5);
  system.masses[1].mass = 3.0;
  system.dampers = {{"c1", k_ground, 0, 0.1}, {"c2", 0, 1, 0.2}};
  return system;
}

/// The matrix of connectors summed one by one.
Eigen::MatrixXd assembled(const std::vector<Connector>& connectors, Eigen::Index masses) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(masses, masses);
  for (const Connector& connector : connectors) sum += connector.value * unit_connector_matrix(connector, masses);
  return sum;
}

Eigen::MatrixXd assembled(const std::vector<PointMass>& masses) {
  Eigen::VectorXd diagonal(masses.size());
  for (std::size_t i = 0; i < masses.size(); ++i) diagonal(static_cast<Eigen::Index>(i)) = masses[i].mass;
  return diagonal.asDiagonal();
}

std::string refusal(const std::vector<ParameterTargets>& parameters) {
  MassSpringSystem system = damped_system();
  system.springs[2].value = 0.0;
  return test::message_of<InvalidInput>([&] { separate(system, parameters); });
}

// By hand from the springs of [Mares2006], Fig. 1: K = [k1+k4+k6, -k4, -k6; -k4, k2+k4+k5, -k5; -k6, -k5, k3+k5+k6].
TEST(Separate, GivesThePublishedMatrixOfThreeMasses) {
  const AffineStructure structure =
      separate(test::three_mass_system(), test::one_each({"spring:k1", "spring:k2", "spring:k5"}));
  const Eigen::Vector3d k(0.7, 1.3, 0.9);
  const Eigen::Matrix3d expected =
      (Eigen::Matrix3d() << k(0) + 4.0, -1.0, -3.0, -1.0, k(1) + 1.0 + k(2), -k(2), -3.0, -k(2), 4.0 + k(2)).finished();
  EXPECT_TRUE(structure.stiffness.at(k).isApprox(expected, 1e-15));
  EXPECT_TRUE(structure.mass.at(k).isIdentity(0.0));
}

TEST(Separate, GivesTheMatricesOfAStructureAssembledWithTheSameValues) {
  const AffineStructure structure = separate(
      damped_system(), test::one_each({"spring:k1", "mass:m2", "damper:c2", "spring:kc", "mass:m1", "damper:c1"}));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.1, 10.0);
  for (int repetition = 0; repetition < 50; ++repetition) {
    Eigen::VectorXd x(6);
    for (double& value : x) value = uniform(random);
    MassSpringSystem system = damped_system();
    system.springs[0].value = x(0);
    system.masses[1].mass = x(1);
    system.dampers[1].value = x(2);
    system.springs[2].value = x(3);
    system.masses[0].mass = x(4);
    system.dampers[0].value = x(5);
    // Sums of three terms, in another order.
    EXPECT_TRUE(structure.stiffness.at(x).isApprox(assembled(system.springs, 2), 1e-15));
    EXPECT_TRUE(structure.mass.at(x).isApprox(assembled(system.masses), 1e-15));
    EXPECT_TRUE(structure.damping.at(x).isApprox(assembled(system.dampers, 2), 1e-15));
  }
}

TEST(Separate, WithoutParametersGivesTheNominalStructure) {
  const MassSpringSystem system = damped_system();
  const AffineStructure structure = separate(system, {});
  EXPECT_TRUE(structure.stiffness.terms.empty());
  EXPECT_TRUE(structure.stiffness.at(Eigen::VectorXd()).isApprox(assembled(system.springs, 2), 1e-15));
  EXPECT_TRUE(structure.damping.at(Eigen::VectorXd()).isApprox(assembled(system.dampers, 2), 1e-15));
}

TEST(Separate, MovesEveryElementTiedToOneParameter) {
  const AffineStructure structure = separate(damped_system(), {{"k", {"spring:k1", "spring:k2"}, false}});
  const Eigen::Matrix2d expected = (Eigen::Matrix2d() << 7.5, -0.5, -0.5, 7.5).finished();
  EXPECT_EQ(structure.stiffness.terms.size(), 1U);
  EXPECT_TRUE(structure.stiffness.at(Eigen::VectorXd::Constant(1, 7.0)).isApprox(expected, 1e-15));
}

TEST(Separate, LetsOneParameterActOnSeveralMatrices) {
  const AffineStructure structure = separate(damped_system(), {{"x", {"spring:k1", "mass:m1", "damper:c1"}, false}});
  const Eigen::Matrix2d corner = (Eigen::Matrix2d() << 1.0, 0.0, 0.0, 0.0).finished();
  EXPECT_EQ(structure.stiffness.derivative(0), corner);
  EXPECT_EQ(structure.mass.derivative(0), corner);
  EXPECT_EQ(structure.damping.derivative(0), corner);
}

TEST(Separate, AFactorOfOneGivesTheNominalStructure) {
  const MassSpringSystem system = damped_system();
  const AffineStructure structure = separate(system, {{"all", {"spring:k1", "spring:k2", "spring:kc"}, true}});
  EXPECT_TRUE(structure.stiffness.at(Eigen::VectorXd::Ones(1)).isApprox(assembled(system.springs, 2), 1e-15));
}

TEST(Separate, AFactorKeepsTheRatioOfTiedElements) {
  const MassSpringSystem system = damped_system();
  const AffineStructure structure = separate(system, {{"all", {"spring:k1", "spring:k2", "spring:kc"}, true}});
  EXPECT_TRUE(
      structure.stiffness.at(Eigen::VectorXd::Constant(1, 2.5)).isApprox(2.5 * assembled(system.springs, 2), 1e-15));
}

TEST(Separate, NamesDegreesOfFreedomByTheirMass) {
  EXPECT_THAT(separate(damped_system(), {}).degree_of_freedom_names, ::testing::ElementsAre("m1", "m2"));
}

TEST(AffineMatrix, DerivativeOfAParameterThatActsElsewhereIsZero) {
  const AffineStructure structure = separate(damped_system(), test::one_each({"spring:k1", "mass:m1"}));
  EXPECT_EQ(structure.stiffness.derivative(1), Eigen::Matrix2d::Zero());
}

TEST(Separate, SuggestsTheNearestTargetForAnUnknownOne) {
  EXPECT_THAT(refusal(test::one_each({"spring:k3"})), HasSubstr("did you mean 'spring:k"));
  EXPECT_THAT(refusal({{"stiff", {"sprnig:k2"}, false}}),
              ::testing::AllOf(HasSubstr("parameter 'stiff'"), HasSubstr("did you mean 'spring:k2'?")));
}

TEST(Separate, RefusesATargetTiedToTwoParameters) {
  EXPECT_EQ(refusal({{"a", {"spring:k1"}, false}, {"b", {"spring:k2", "spring:k1"}, false}}),
            "parameter 'b': target 'spring:k1' is already tied to parameter 'a'");
}

TEST(Separate, RefusesATargetNamedTwiceByOneParameter) {
  EXPECT_THAT(refusal({{"a", {"spring:k1", "spring:k1"}, false}}), HasSubstr("already tied"));
}

TEST(Separate, RefusesAParameterWithoutTarget) {
  EXPECT_THAT(refusal({{"a", {}, false}}), HasSubstr("parameter 'a': it has no target"));
}

TEST(Separate, RefusesAFactorOnNothing) {
  EXPECT_THAT(refusal({{"a", {"spring:kc"}, true}}), HasSubstr("nominal value is 0"));
  EXPECT_EQ(refusal({{"a", {"spring:kc"}, false}}), "nothing thrown");
}

TEST(Separate, RefusesAnUnsoundSystem) {
  MassSpringSystem system = damped_system();
  system.masses[0].mass = -1.0;
  EXPECT_THROW(separate(system, {}), InvalidInput);
}

TEST(PhysicalLimit, AllowsZeroForDampersAlone) {
  EXPECT_FALSE(physical_limit({"c", {"damper:c1", "damper:c2"}, false}).excludes_lower);
}

TEST(PhysicalLimit, ExcludesZeroForASpringOrMass) {
  EXPECT_TRUE(physical_limit({"k", {"spring:k1"}, false}).excludes_lower);
  EXPECT_TRUE(physical_limit({"m", {"mass:m1"}, false}).excludes_lower);
  EXPECT_TRUE(physical_limit({"x", {"damper:c1", "spring:k1"}, false}).excludes_lower);
}

}  // namespace
}  // namespace mottle::model
