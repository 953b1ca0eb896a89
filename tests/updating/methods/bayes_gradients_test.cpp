// `bayes` along gradients of a model of many parameters.
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

using test::says;

TEST(Bayes, SaysWhyManyParametersAreMovedWithoutGradients) {
  const test::SpringChain chain(16);
  UpdatingProblem problem = chain.problem();
  EXPECT_FALSE(says(BayesUpdater({.particles = 100}).update(problem, {}), "without gradients"));
  problem.derivatives = nullptr;
  EXPECT_TRUE(says(BayesUpdater({.particles = 100}).update(problem, {}), "16 parameters were moved without gradients"));
}

}  // namespace
}  // namespace mottle::updating
