// Modes that change their order: tracked by rank and by MAC.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/structures.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"

namespace mottle::model {
namespace {

constexpr double k_two_pi = 2.0 * std::numbers::pi;

/// Two uncoupled oscillators, k1 the parameter, k2 = 2; reference k1 = 1. Their frequencies cross at k1 = 2.
StructureModel crossing(OutputSelection outputs) {
  return {separate(test::two_mass_system(1.0, 2.0, 0.0), test::one_each({"spring:k1"})), std::move(outputs),
          Eigen::VectorXd::Ones(1)};
}

Eigen::RowVectorXd outputs_at(const Model& model, double k1) {
  return model.evaluate(Eigen::MatrixXd::Constant(1, 1, k1), {}).outputs.row(0);
}

TEST(Tracking, ByOrderNumbersModesByTheirFrequency) {
  const Eigen::RowVectorXd f = outputs_at(crossing({.frequencies = {1, 2}}), 4.0);
  EXPECT_NEAR(f(0), std::sqrt(2.0) / k_two_pi, 1e-15);
  EXPECT_NEAR(f(1), 2.0 / k_two_pi, 1e-15);
}

TEST(Tracking, ByMacKeepsANumberWithItsShapeThroughACrossing) {
  const StructureModel model = crossing({.frequencies = {1, 2}, .tracking = ModeTracking::mac});
  for (const double k1 : {0.25, 1.0, 1.999, 2.001, 4.0, 9.0}) {
    const Eigen::RowVectorXd f = outputs_at(model, k1);
    EXPECT_NEAR(f(0), std::sqrt(k1) / k_two_pi, 1e-15) << k1;
    EXPECT_NEAR(f(1), std::sqrt(2.0) / k_two_pi, 1e-15) << k1;
  }
}

TEST(Tracking, ByMacFollowsAModeOutOfTheWantedBand) {
  const StructureModel model = crossing({.frequencies = {1}, .tracking = ModeTracking::mac});
  EXPECT_NEAR(outputs_at(model, 9.0)(0), 3.0 / k_two_pi, 1e-15);
}

TEST(Tracking, ByMacTakesTheShapeFromTheTrackedMode) {
  const StructureModel model =
      crossing({.shape_modes = {1}, .shape_degrees_of_freedom = {"m1", "m2"}, .tracking = ModeTracking::mac});
  EXPECT_NEAR(std::abs(outputs_at(model, 4.0)(0)), 1.0, 1e-15);
  EXPECT_NEAR(outputs_at(model, 4.0)(1), 0.0, 1e-15);
}

// c1 = 0.2 on the first mass, c2 = 0.4 on the second: zeta = c / (2 omega), whichever is the lower mode.
TEST(Tracking, ByMacTakesTheDampingRatioFromTheTrackedMode) {
  MassSpringSystem system = test::two_mass_system(1.0, 2.0, 0.0);
  system.dampers = {{"c1", k_ground, 0, 0.2}, {"c2", k_ground, 1, 0.4}};
  const StructureModel model(separate(system, test::one_each({"spring:k1"})),
                             {.damping = {1, 2}, .tracking = ModeTracking::mac}, Eigen::VectorXd::Ones(1));
  const Eigen::RowVectorXd zeta = outputs_at(model, 4.0);
  EXPECT_NEAR(zeta(0), 0.1 / 2.0, 1e-14);
  EXPECT_NEAR(zeta(1), 0.2 / std::sqrt(2.0), 1e-14);
}

/// Uncoupled at the reference kc = 0 with k1 = 1, k2 = 2; parameters k1, k2, kc.
StructureModel coupled(double minimum_mac, std::vector<int> modes = {1}) {
  return {separate(test::two_mass_system(1.0, 2.0, 0.0), test::one_each({"spring:k1", "spring:k2", "spring:kc"})),
          {.frequencies = std::move(modes), .tracking = ModeTracking::mac, .minimum_mac = minimum_mac},
          Eigen::Vector3d(1.0, 2.0, 0.0)};
}

// Equal masses and springs, coupled: the shapes are (1, 1) and (1, -1), MAC 0.5 with each axis.
TEST(Tracking, ALostModeIsAFailureThatNamesItsMac) {
  const Evaluation evaluation = coupled(0.6).evaluate(Eigen::RowVector3d(1.0, 1.0, 1.0), {});
  ASSERT_EQ(evaluation.failures.size(), 1U);
  EXPECT_EQ(evaluation.failures[0].reason, "mode 1 is lost: its best MAC with the reference is 0.50");
  EXPECT_TRUE(evaluation.outputs.array().isNaN().all());
}

TEST(Tracking, ALostModeCostsItsOwnSampleAlone) {
  Eigen::MatrixXd samples(3, 3);
  samples << 1.0, 2.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 0.0;
  const Evaluation evaluation = coupled(0.6).evaluate(samples, {});
  ASSERT_EQ(evaluation.failures.size(), 1U);
  EXPECT_EQ(evaluation.failures[0].sample, 1);
  EXPECT_TRUE(evaluation.outputs.row(0).allFinite() && evaluation.outputs.row(2).allFinite());
}

// With both modes among the outputs the same sample is kept: together they still span what the reference's two span.
TEST(Tracking, ModesThatMixAmongThemselvesAreKeptWithANote) {
  const Evaluation evaluation = coupled(0.6, {1, 2}).evaluate(Eigen::RowVector3d(1.0, 1.0, 1.0), {});
  EXPECT_TRUE(evaluation.failures.empty());
  ASSERT_EQ(evaluation.notes.size(), 1U);
  EXPECT_NE(evaluation.notes[0].text.find("modes 1, 2 mixed"), std::string::npos) << evaluation.notes[0].text;
}

TEST(Tracking, ACrossingIsNoted) {
  const Evaluation evaluation = coupled(0.6, {1, 2}).evaluate(Eigen::RowVector3d(2.0, 1.0, 0.0), {});
  ASSERT_EQ(evaluation.notes.size(), 1U);
  EXPECT_EQ(evaluation.notes[0].text, "modes 1 and 2 crossed");
}

TEST(Tracking, KeepsAModeWhoseMacIsAboveTheLimit) {
  EXPECT_TRUE(coupled(0.4).evaluate(Eigen::RowVector3d(1.0, 1.0, 1.0), {}).failures.empty());
}

}  // namespace
}  // namespace mottle::model
