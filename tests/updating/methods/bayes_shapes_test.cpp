// `bayes` on many modes and bent ridges: that it converges, what it says it will cost, and how it ends before.
#include "support/bayes_shapes.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/bayes.hpp"

namespace mottle::updating {
namespace {

using test::ShapedPosterior;

/// Keeps the first statement of the expected number of runs.
class Listener final : public ProgressObserver {
 public:
  void progress(const std::string& /*work*/, std::int64_t /*done*/, std::int64_t /*total*/) override {}
  void warning(const std::string& /*text*/) override {}
  void note(const std::string& /*text*/) override {}
  void finding(const std::string& text) override {
    double millions = 0.0;
    if (expected == 0.0 && std::sscanf(text.c_str(), "about %lf million model runs expected", &millions) == 1)
      expected = 1e6 * millions;
  }
  double expected = 0.0;
};

struct Run {
  UpdatingResult result;
  double expected = 0.0;
};

Run run(const ShapedPosterior& shape, const BayesOptions& options = {}) {
  Listener listener;
  Run made{.result = BayesUpdater(options).update(shape.problem(), {.seed = 1, .observer = &listener})};
  made.expected = listener.expected;
  return made;
}

/// @param most  model runs of the sampler
void expect_sound(const ShapedPosterior& shape, std::int64_t most) {
  constexpr double k_errors = 4.0;
  const UpdatingResult result = run(shape).result;
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  const SampledPosterior& posterior = *result.posterior;
  EXPECT_NEAR(posterior.evidence.log_evidence, shape.log_evidence, k_errors * posterior.evidence.standard_error);
  EXPECT_LT(posterior.evidence.standard_error, 0.08);
  for (Eigen::Index i = 0; i < shape.mean.size(); ++i) {  // as if an eighth of the 8,000 draws were independent
    EXPECT_NEAR(result.mean(i), shape.mean(i), k_errors * shape.standard_deviation(i) / std::sqrt(1000.0));
    EXPECT_NEAR(std::sqrt(result.covariance(i, i)), shape.standard_deviation(i), 0.06 * shape.standard_deviation(i));
  }
  EXPECT_LT(posterior.evaluations, most);
}

// References: test::permuted_modes() and test::banana(), integrals over one parameter.
TEST(BayesShapes, FindsSixPermutedModesInAMillionRuns) {
  expect_sound(test::permuted_modes(3, 0.003), 2000000);
}

// Of a banana it is too low: the stages to come take more moves than those before.
TEST(BayesShapes, SaysAtTheStartHowManyRunsPermutedModesTakeWithinAFactorOfTwo) {
  const auto [result, expected] = run(test::permuted_modes(3, 0.003));
  EXPECT_LT(expected, 2.0 * static_cast<double>(result.posterior->evaluations));
  EXPECT_GT(expected, 0.5 * static_cast<double>(result.posterior->evaluations));
}

TEST(BayesShapes, FollowsABanana) {
  expect_sound(test::banana(1.0, 0.05), 2500000);
}

TEST(BayesShapes, EndsAtMaxEvaluationsWithoutEvidence) {
  const ShapedPosterior shape = test::permuted_modes(3, 0.003);
  const UpdatingResult result = run(shape, {.particles = 200, .max_evaluations = 30000}).result;
  EXPECT_EQ(result.status, UpdatingStatus::max_iterations);
  EXPECT_NE(result.message.find("bayes.max_evaluations = 30000"), std::string::npos) << result.message;
  EXPECT_NE(result.message.find("there is no evidence"), std::string::npos) << result.message;
  EXPECT_LE(result.posterior->evaluations, 30000);
  EXPECT_TRUE(std::isnan(result.posterior->evidence.log_evidence));
  EXPECT_TRUE(result.estimate != nullptr);
}

TEST(BayesShapes, IsNotChangedByALimitThatItDoesNotReach) {
  const ShapedPosterior shape = test::banana(1.0, 0.05);
  const UpdatingResult free = run(shape, {.particles = 200}).result;
  const UpdatingResult limited = run(shape, {.particles = 200, .max_evaluations = 100000000}).result;
  EXPECT_EQ(free.posterior->values, limited.posterior->values);
  EXPECT_EQ(free.status, limited.status);
}

TEST(BayesShapes, RefusesALimitBelowItsFirstMove) {
  EXPECT_THROW(run(test::banana(1.0, 0.05), {.max_evaluations = 10000}), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
