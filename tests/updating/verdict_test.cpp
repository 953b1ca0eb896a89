#include "mottle/updating/verdict.hpp"

#include <gtest/gtest.h>

#include "mottle/core/random.hpp"
#include "mottle/stats/descriptive.hpp"
#include "mottle/stats/standard_normal.hpp"
#include "mottle/updating/iteration.hpp"
#include "mottle/updating/mares.hpp"
#include "support/three_masses.hpp"

namespace mottle {
namespace {

using test::frequencies_of;
using test::oracle_parameters;
using test::ThreeMasses;

TEST(Verdict, TheRightParametersAreAdequate) {
  const ThreeMasses structure;
  const UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  EXPECT_EQ(judge(problem, MaresUpdater({}).update(problem, {})).conclusion, Conclusion::adequate);
}

TEST(Verdict, AParameterOnItsBoundIsInadequateAndNamed) {
  const ThreeMasses truth(3.0);
  const ThreeMasses without_k6(0.0);
  const UpdatingProblem problem = without_k6.problem(frequencies_of(truth, oracle_parameters()));
  const Verdict verdict = judge(problem, MaresUpdater({}).update(problem, {}));
  EXPECT_EQ(verdict.conclusion, Conclusion::inadequate);
  bool is_named = false;
  for (const std::string& reason : verdict.reasons) {
    is_named = is_named || reason.find("k2 ended on its lower bound, 0.5") != std::string::npos;
  }
  EXPECT_TRUE(is_named);
}

TEST(Verdict, AnIterationThatDidNotConvergeIsUndecided) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.iterations = 2;
  EXPECT_EQ(judge(problem, MaresUpdater({}).update(problem, {})).conclusion, Conclusion::undecided);
}

/// Part of 2000 replications of ten right specimens that the test rejects. The three outputs scatter together alone,
/// but for the noise.
double rejected_part(double noise, double known_noise) {
  constexpr int k_replications = 2000;
  constexpr int k_specimens = 10;
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(Eigen::MatrixXd::Zero(k_specimens, 3));
  problem.tests.repeatability_std = Eigen::Vector3d::Constant(known_noise);
  RandomStream stream({.seed = 5, .purpose = StreamPurpose::truth}, 0);
  const auto normal = [&] { return standard_normal_quantile(stream.uniform()); };
  int rejected = 0;
  for (int r = 0; r < k_replications; ++r) {
    IterationRecord state;
    state.cloud.outputs.resize(1000, 3);
    for (auto row : state.cloud.outputs.rowwise()) row.setConstant(normal());
    state.cloud.samples = state.cloud.outputs;
    state.output_mean = sample_mean(state.cloud.outputs);
    state.output_covariance = sample_covariance(state.cloud.outputs);
    for (auto row : problem.tests.values.rowwise()) {
      row.setConstant(normal());
      for (double& value : row) value += noise * normal();
    }
    if (!mean_agreement_test(problem, state, 0.05).passed) ++rejected;
  }
  return static_cast<double>(rejected) / k_replications;
}

TEST(MeanAgreement, RejectsAsOftenAsItSaysWhereTheNoiseIsKnown) {
  EXPECT_NEAR(rejected_part(0.1, 0.1), 0.05, 0.02);  // 4 standard errors
  EXPECT_GT(rejected_part(0.1, 0.0), 0.5);           // unknown noise is taken for a difference
}

TEST(Identifiability, SingularValuesOfAScaledDiagonalSensitivityAreItsRatios) {
  const Eigen::Matrix2d g = Eigen::Vector2d(4.0, 3.0).asDiagonal();
  const Identifiability seen = identify(g, Eigen::Vector2d(2.0, 1.0), Eigen::Vector2d(0.5, 2.0));
  EXPECT_EQ(seen.rank, 2);
  EXPECT_DOUBLE_EQ(seen.singular_values(0), 6.0);  // 3 * 2 / 1
  EXPECT_DOUBLE_EQ(seen.singular_values(1), 1.0);  // 4 * 0.5 / 2
  EXPECT_TRUE(seen.unseen_directions.empty());
}

TEST(Identifiability, ParametersThatActOnlyTogetherLeaveTheirDifferenceUnseen) {
  Eigen::MatrixXd g(2, 2);
  g << 1.0, 1.0, 2.0, 2.0;
  const Identifiability seen = identify(g, Eigen::Vector2d::Ones(), Eigen::Vector2d::Ones());
  EXPECT_EQ(seen.rank, 1);
  ASSERT_EQ(seen.unseen_directions.size(), 1U);
  EXPECT_NEAR(seen.unseen_directions[0].sum(), 0.0, 1e-12);
}

TEST(Identifiability, MoreParametersThanOutputsLeaveTheRestUnseen) {
  const Identifiability seen =
      identify(Eigen::RowVector3d(1.0, 0.0, 0.0), Eigen::VectorXd::Ones(1), Eigen::Vector3d::Ones());
  EXPECT_EQ(seen.rank, 1);
  EXPECT_EQ(seen.unseen_directions.size(), 2U);
}

TEST(AutomaticSamples, GiveATenthOfTheTestsStandardErrorAtLeast) {
  EXPECT_GE(automatic_samples(10, 3, 0.05), 1000);
  EXPECT_GE(automatic_samples(100, 3, 0.05), 10000);
}

TEST(LargestMovement, IsMeasuredInPriorDeviations) {
  const Eigen::Vector2d before(1.0, 2.0);
  const Eigen::Vector2d after(1.1, 2.1);
  const Eigen::Matrix2d still = Eigen::Matrix2d::Identity();
  EXPECT_NEAR(largest_movement(Eigen::Vector2d(0.1, 1.0), before, still, after, still), 1.0, 1e-12);
  EXPECT_NEAR(largest_movement(Eigen::Vector2d(1.0, 0.5), before, still, before, 4.0 * still), 2.0, 1e-12);
}

TEST(IsStalled, OnlyWhenNoLaterMovementIsSmaller) {
  EXPECT_FALSE(is_stalled({1.0, 0.5, 0.4, 0.3}, 3));
  EXPECT_TRUE(is_stalled({1.0, 0.5, 0.7, 0.6, 0.8}, 3));
  EXPECT_FALSE(is_stalled({0.1, 0.2}, 3));
}

}  // namespace
}  // namespace mottle
