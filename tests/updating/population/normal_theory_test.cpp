#include "updating/population/normal_theory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "support/instrumented.hpp"

namespace mottle::updating {
namespace {

using Kind = ParameterTransform::Kind;

/// Part of 300 samples of `count` logarithms N(0.2, 0.3^2) whose intervals hold the mean and the deviation of x.
Eigen::Vector2d coverage_of_a_lognormal(int count) {
  constexpr int k_replications = 300;
  const double true_mean = std::exp(0.2 + 0.5 * 0.09);
  const double true_std = true_mean * std::sqrt(std::expm1(0.09));
  Eigen::Vector2d held = Eigen::Vector2d::Zero();
  for (int r = 0; r < k_replications; ++r) {
    RandomStream stream({.seed = 77}, static_cast<std::uint32_t>(r));
    Eigen::VectorXd t(count);
    for (double& value : t) value = 0.2 + 0.3 * standard_normal_quantile(stream.uniform());
    const double variance = (t.array() - t.mean()).square().sum() / (count - 1);
    const ParameterIntervals intervals =
        normal_theory_intervals({ParameterTransform{Kind::log}}, Eigen::VectorXd::Constant(1, t.mean()),
                                Eigen::MatrixXd::Constant(1, 1, variance), count, {});
    held(0) += intervals.mean(0, 0) <= true_mean && true_mean <= intervals.mean(0, 1) ? 1 : 0;
    held(1) += intervals.std(0, 0) <= true_std && true_std <= intervals.std(0, 1) ? 1 : 0;
  }
  return held / k_replications;
}

TEST(NormalTheory, IntervalsOfALognormalHoldTheTruthIn95PerCent) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  const Eigen::Vector2d coverage = coverage_of_a_lognormal(10);
  // Three standard errors of 300 replications are 3.8 %.
  EXPECT_NEAR(coverage(0), 0.95, 0.038);
  EXPECT_NEAR(coverage(1), 0.95, 0.038);
}

TEST(NormalTheory, AParameterOfNoScatterHasPointIntervalsAndNoCorrelation) {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  covariance(0, 0) = 0.04;
  const ParameterIntervals intervals = normal_theory_intervals({{}, {}}, Eigen::Vector2d(1.0, 2.0), covariance, 8, {});
  EXPECT_EQ(intervals.mean(1, 0), 2.0);
  EXPECT_EQ(intervals.std(1, 1), 0.0);
  EXPECT_EQ(intervals.correlation_lower(0, 1), -1.0);
  EXPECT_EQ(intervals.correlation_upper(1, 0), 1.0);
}

TEST(NormalTheory, ParametersOfDifferentGroupsAreKnownToBeUncorrelated) {
  const ParameterIntervals intervals =
      normal_theory_intervals({{}, {}}, Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity(), 8, {0, 1});
  EXPECT_EQ(intervals.correlation_lower(0, 1), 0.0);
  EXPECT_EQ(intervals.correlation_upper(0, 1), 0.0);
}

TEST(NormalTheory, TheCorrelationOfLognormalsIsCarriedOverInClosedForm) {
  Eigen::Matrix2d covariance;
  covariance << 0.09, 0.03, 0.03, 0.04;
  const ParameterTransform log{Kind::log};
  const ParameterIntervals scaled = normal_theory_intervals({{}, {}}, Eigen::Vector2d::Zero(), covariance, 8, {});
  const ParameterIntervals intervals = normal_theory_intervals({log, log}, Eigen::Vector2d::Zero(), covariance, 8, {});
  const double rho = scaled.correlation_upper(0, 1);
  const double expected = std::expm1(rho * 0.3 * 0.2) / std::sqrt(std::expm1(0.09) * std::expm1(0.04));
  EXPECT_NEAR(intervals.correlation_upper(0, 1), expected, 1e-12);
}

}  // namespace
}  // namespace mottle::updating
