// What `bayes` refuses, and input at the edge of what it takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "support/common_linear.hpp"
#include "support/methods.hpp"

namespace mottle::updating {
namespace {

using test::CommonLinear;
using test::mean_error;

template <typename Error>
std::string refusal_of(const UpdatingProblem& problem, const BayesOptions& options = {}) {
  try {
    BayesUpdater(options).update(problem, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Bayes, RefusesAModelThatFailsEverywhere) {
  CommonLinear linear;
  linear.model.fails = [](const Eigen::RowVectorXd&) { return true; };
  EXPECT_NE(refusal_of<SystemFailure>(linear.problem()).find("100 of 100 model runs failed"), std::string::npos);
}

/// Five specimens that a model of two parameters meets exactly: the level of the noise goes to zero.
TEST(Bayes, RefusesNoiseWhoseLikelihoodGrowsWithoutEnd) {
  CommonLinear linear;
  linear.tests.repeatability_std.setZero();
  const Eigen::RowVector2d truth(1.1, 2.2);
  linear.tests.values = linear.model.evaluate(truth, {}).outputs.replicate(5, 1);
  const std::string refusal = refusal_of<InvalidInput>(linear.problem(), {.particles = 200});
  EXPECT_NE(refusal.find("the level noise:outputs has no posterior"), std::string::npos) << refusal;
  const BayesOptions proper{.noise_prior = BayesOptions::NoisePrior::inverse_gamma, .particles = 200};
  EXPECT_EQ(refusal_of<InvalidInput>(linear.problem(), proper), "accepted");
}

TEST(Bayes, RefusesNoiseThatIsFarBelowTheTestedValues) {
  CommonLinear linear;
  linear.tests.repeatability_std.setConstant(1e-12);
  const std::string refusal = refusal_of<InvalidInput>(linear.problem(), {.particles = 200});
  EXPECT_NE(refusal.find("rounding decides"), std::string::npos) << refusal;
  const BayesOptions estimated{.noise = BayesOptions::Noise::estimated, .particles = 200};
  EXPECT_EQ(refusal_of<InvalidInput>(linear.problem(), estimated).find("rounding decides"), std::string::npos);
}

/// One specimen of one output more than parameters, met to `apart`: the level's density falls as its inverse from the
/// prior's scale down to there.
UpdatingResult update_met_within(double apart, std::uint64_t seed) {
  CommonLinear linear;
  linear.tests.repeatability_std.setZero();
  linear.tests.values = linear.model.evaluate(Eigen::RowVector2d(1.1, 2.2), {}).outputs;
  linear.tests.values(0, 0) += apart;
  return BayesUpdater({.particles = 500}).update(linear.problem(), {.seed = seed});
}

TEST(Bayes, IsNotConvergedWhereTheNoiseMayBeFarSmallerThanItsDraws) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const UpdatingResult met = update_met_within(1e-8, seed);
    EXPECT_EQ(met.status, UpdatingStatus::stalled);
    EXPECT_TRUE(std::ranges::any_of(met.warnings, [](const std::string& warning) {
      return warning.find("the sampler does not reach") != std::string::npos;
    })) << met.message;
    for (const std::string& warning : update_met_within(0.05, seed).warnings)
      EXPECT_EQ(warning.find("the sampler does not reach"), std::string::npos) << warning;
  }
}

TEST(Bayes, RefusesMoreDrawsThanMemoryHolds) {
  const CommonLinear linear;
  const std::string refusal = refusal_of<InvalidInput>(linear.problem(), {.islands = 256, .particles = 100000});
  EXPECT_NE(refusal.find("256 islands of 100000 particles"), std::string::npos) << refusal;
}

TEST(Bayes, LeavesAParameterWithoutInfluenceAsThePriorHasIt) {
  CommonLinear linear;
  Eigen::MatrixXd slope = CommonLinear::slope();
  slope.col(1).setZero();
  const test::LinearModel blind(Eigen::Vector3d(1.0, 0.0, 2.0), slope);
  const UpdatingProblem problem{
      .model = blind, .space = *linear.space, .tests = linear.tests, .cloud = {.samples = 100}};
  const UpdatingResult result = BayesUpdater({}).update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_NEAR(result.mean(1), 2.0, mean_error(result, 1));
  EXPECT_NEAR(std::sqrt(result.covariance(1, 1)), 0.5, 0.08 * 0.5);
}

TEST(Bayes, LeavesOutASpecimenWithoutValues) {
  CommonLinear linear;
  const UpdatingResult all = BayesUpdater({.particles = 100}).update(linear.problem(), {});
  linear.tests.values.conservativeResize(5, Eigen::NoChange);
  linear.tests.values.row(4).setConstant(std::numeric_limits<double>::quiet_NaN());
  const UpdatingResult one_more = BayesUpdater({.particles = 100}).update(linear.problem(), {});
  EXPECT_EQ(all.posterior->values, one_more.posterior->values);
}

}  // namespace
}  // namespace mottle::updating
