// Updates by surrogate against the same updates in the model itself.
#include "mottle/updating/methods/surrogate_update.hpp"

#include <gtest/gtest.h>

#include "mottle/core/error.hpp"
#include "mottle/model/function_model.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

/// Counts what it is asked, and fails where it is told to.
class CountedModel final : public Model {
 public:
  explicit CountedModel(const Model& model) : model_(model) {}
  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    Evaluation evaluation = model_.evaluate(samples, context);
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      if (fails_every == 0 || (count + s) % fails_every != 0) continue;
      evaluation.outputs.row(s).setConstant(std::nan(""));
      evaluation.failures.push_back({s, "crashed"});
    }
    count += samples.rows();
    return evaluation;
  }

  mutable std::int64_t count = 0;
  int fails_every = 0;

 private:
  const Model& model_;
};

struct Bench {
  Bench() : counted(*structure.model), tests(test::frequencies_of(structure, test::oracle_parameters())) {}
  UpdatingProblem problem() const {
    const UpdatingProblem plain = structure.problem(tests);
    return {.model = counted,
            .space = plain.space,
            .tests = plain.tests,
            .cloud = plain.cloud,
            .iterations = plain.iterations};
  }
  test::ThreeMasses structure;
  CountedModel counted;
  Eigen::MatrixXd tests;
};

TEST(SurrogateUpdate, FindsWhatTheModelItselfFinds) {
  for (const SurrogateKind kind : {SurrogateKind::quadratic, SurrogateKind::kriging, SurrogateKind::chaos}) {
    const Bench bench;
    const MaximumLikelihoodUpdater method({});
    const UpdatingResult direct = method.update(bench.structure.problem(bench.tests), {});
    const UpdatingProblem problem = bench.problem();
    SurrogateUpdate update(problem, {.kind = kind});
    const UpdatingResult result = update.run(method, {});
    ASSERT_EQ(result.status, UpdatingStatus::converged);
    EXPECT_TRUE(update.is_good());
    EXPECT_EQ(result.model_evaluations, bench.counted.count);
    EXPECT_LE(bench.counted.count, 80);
    // What the surrogate may be off in the outputs is more in the parameters, which several outputs share.
    const Eigen::VectorXd standard_deviation = direct.covariance.diagonal().cwiseSqrt();
    EXPECT_LT(((result.mean - direct.mean).cwiseQuotient(standard_deviation)).cwiseAbs().maxCoeff(), 0.15);
    EXPECT_LT(
        (result.covariance.diagonal().cwiseSqrt().cwiseQuotient(standard_deviation).array() - 1.0).abs().maxCoeff(),
        0.1);
  }
}

TEST(SurrogateUpdate, CarriesItsErrorIntoTheTestsNoise) {
  const Bench bench;
  UpdatingProblem problem = bench.problem();
  problem.tests.repeatability_std.setConstant(0.003);
  SurrogateUpdate update(problem, {.kind = SurrogateKind::quadratic, .rounds = 0});
  update.run(MaximumLikelihoodUpdater({}), {});
  ASSERT_EQ(update.rounds().size(), 1U);
  const Eigen::VectorXd error = update.rounds().front().carried_error;
  EXPECT_GT(error.minCoeff(), 0.0);
  for (Eigen::Index k = 0; k < error.size(); ++k) {
    EXPECT_DOUBLE_EQ(update.problem().tests.repeatability_std(k), std::hypot(0.003, error(k)));
  }
}

/// A design of ten runs a parameter is not enough for a tolerance of a thousandth: rounds follow, and end.
TEST(SurrogateUpdate, RefinesWhereTheEstimateLies) {
  const Bench bench;
  const UpdatingProblem problem = bench.problem();
  SurrogateUpdate update(problem, {.kind = SurrogateKind::kriging, .runs = 12, .rounds = 2, .tolerance = 1e-6});
  const UpdatingResult result = update.run(MaximumLikelihoodUpdater({}), {});
  ASSERT_EQ(update.rounds().size(), 3U);
  EXPECT_FALSE(update.is_good());
  EXPECT_LT(update.rounds().back().error_at_estimate.norm(), 0.5 * update.rounds().front().error_at_estimate.norm());
  EXPECT_NE(result.notes.back().find("still off"), std::string::npos);
}

/// y = x + 0.02 sin 15 (x - 3), which a quadratic takes for y = x: off by 0.02 at most, a fifteenth of the tests'
/// scatter, and by up to 23 % in the slope about 3, where the estimate lies; the tests' scatter is nearly all noise.
TEST(SurrogateUpdate, IsNotGoodWhereItsScatterIsOff) {
  const FunctionModel model(1, {named_quantity("y", "-")}, [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(x.array() + 0.02 * (15.0 * (x.array() - 3.0)).sin());
  });
  const ParameterSpace space(
      {{"x", "-"}}, JointDistribution({Distribution({.kind = DistributionKind::normal, .mean = 3.0, .std = 1.0})}));
  const Eigen::MatrixXd tests = Eigen::VectorXd::LinSpaced(9, 2.56, 3.44);  // standard deviation 0.3
  const UpdatingProblem problem{
      .model = model, .space = space, .tests = {tests, Eigen::VectorXd::Constant(1, 0.299)}, .cloud = {.samples = 100}};
  SurrogateUpdate update(problem, {.kind = SurrogateKind::quadratic, .runs = 40, .rounds = 0});
  update.run(MaximumLikelihoodUpdater({}), {});
  const SurrogateRound& last = update.rounds().back();
  EXPECT_LT(last.error_at_estimate(0), 0.1 * 0.3);
  EXPECT_LT(last.scatter_error_at_estimate(0), -0.1);
  EXPECT_GT(last.scatter_error_at_estimate(0), 1.0 / 1.3 - 1.0);
  EXPECT_FALSE(update.is_good());
}

TEST(SurrogateUpdate, LeavesFailedRunsOut) {
  Bench bench;
  bench.counted.fails_every = 7;
  const UpdatingProblem problem = bench.problem();
  SurrogateUpdate update(problem, {.kind = SurrogateKind::quadratic});
  EXPECT_EQ(update.run(MaximumLikelihoodUpdater({}), {}).status, UpdatingStatus::converged);
  EXPECT_LT(update.rounds().front().runs, 30);
}

TEST(SurrogateUpdate, RefusesTooFewRuns) {
  const Bench bench;
  const UpdatingProblem problem = bench.problem();
  SurrogateUpdate update(problem, {.kind = SurrogateKind::quadratic, .runs = 10});
  EXPECT_THROW(update.run(MaximumLikelihoodUpdater({}), {}), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
