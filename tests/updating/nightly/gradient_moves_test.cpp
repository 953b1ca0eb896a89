// Moves along gradients in as many dimensions as `bayes` takes, and what they save.
#include <gtest/gtest.h>

#include "support/linear_normal.hpp"

namespace mottle::updating {
namespace {

using test::LinearNormal;

std::int64_t cost(Eigen::Index dimension, GradientMoves gradients) {
  const LinearNormal linear(dimension);
  sample_posterior(linear.target(), {.particles = 300, .gradients = gradients}, {});
  return linear.evaluations;
}

TEST(GradientMoves, TakeFewerEvaluationsThanOthersInThirtyDimensions) {
  EXPECT_LT(4 * cost(30, GradientMoves::always), cost(30, GradientMoves::never));
}

TEST(GradientMoves, HaveTheClosedFormOfALinearModelOfSixtyParameters) {
  test::expect_closed_form_along_gradients(60);
}

}  // namespace
}  // namespace mottle::updating
