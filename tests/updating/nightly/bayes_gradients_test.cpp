// `bayes` along gradients against another program, and against itself without gradients.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "support/common_linear.hpp"
#include "support/methods.hpp"
#include "support/spring_chain.hpp"

namespace mottle::updating {
namespace {

using test::k_stated_errors;
using test::mean_error;

/// Reference: importance sampling in NumPy, validation/bayes/chain.py; its ln evidence has a standard error of 0.004,
/// its means of 0.5.
TEST(Bayes, FollowsGradientsToTheReferenceOfThirtySprings) {
  const test::SpringChain chain(30);
  const UpdatingResult result = BayesUpdater({.particles = 200}).update(chain.problem(), {});
  const SampledPosterior& posterior = *result.posterior;
  EXPECT_GT(posterior.gradients, 0);
  EXPECT_EQ(posterior.divergences(), 0);
  EXPECT_NEAR(posterior.evidence.log_evidence, 21.0523, k_stated_errors * posterior.evidence.standard_error + 0.012);
  const std::vector<std::pair<Eigen::Index, Eigen::Vector2d>> reference{{0, {1034.45, 98.07}},
                                                                        {2, {931.87, 85.15}},
                                                                        {9, {989.90, 88.37}},
                                                                        {27, {1105.65, 96.42}},
                                                                        {29, {1037.64, 98.46}}};
  for (const auto& [spring, moments] : reference) {
    EXPECT_NEAR(result.mean(spring), moments(0), mean_error(result, spring) + 1.5) << spring;
    EXPECT_NEAR(std::sqrt(result.covariance(spring, spring)), moments(1), 0.1 * moments(1)) << spring;
  }
}

/// The level of the noise among the parameters that gradients move.
TEST(Bayes, SamplesALevelOfTheNoiseAlongGradientsAsWithout) {
  test::SpringChain chain(4);
  UpdatingProblem problem = chain.problem();
  problem.tests.repeatability_std.setZero();
  problem.tests.values.row(0) += 0.01 * Eigen::RowVector4d(0.3, -0.8, 1.1, -0.4);
  const UpdatingResult without = BayesUpdater({.gradients = GradientMoves::never}).update(problem, {});
  const UpdatingResult along = BayesUpdater({.gradients = GradientMoves::always}).update(problem, {});
  EXPECT_GT(along.posterior->gradients, 0);
  EXPECT_NEAR(along.posterior->evidence.log_evidence, without.posterior->evidence.log_evidence,
              k_stated_errors *
                  std::hypot(along.posterior->evidence.standard_error, without.posterior->evidence.standard_error));
  const Eigen::VectorXd levels = along.posterior->values.col(4);
  const Eigen::VectorXd others = without.posterior->values.col(4);
  const double std = std::sqrt((others.array() - others.mean()).square().mean());
  EXPECT_NEAR(levels.mean(), others.mean(),
              k_stated_errors * std * std::sqrt(2.0 / 2000.0));  // as if a quarter counted
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(along.mean(i), without.mean(i), 1.5 * mean_error(without, i));
}

}  // namespace
}  // namespace mottle::updating
