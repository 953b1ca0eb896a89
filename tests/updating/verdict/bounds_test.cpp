// Bounds of populations that are normal on another scale: they hold for the median.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "support/linear_model.hpp"

namespace mottle::updating {
namespace {

/// One parameter that is the output itself, lognormal, with an upper bound of 3.
struct LognormalPopulation {
  LognormalPopulation() {
    Parameter parameter{.name = "a", .unit = "-", .upper_bound = 3.0};
    parameter.transform = {ParameterTransform::Kind::log};
    const Distribution prior({.kind = DistributionKind::lognormal, .mean = 2.0, .std = 1.0});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{parameter}, JointDistribution({prior}));
  }
  UpdatingProblem problem(std::initializer_list<double> logarithms) const {
    Eigen::MatrixXd tests(static_cast<Eigen::Index>(logarithms.size()), 1);
    Eigen::Index row = 0;
    for (const double logarithm : logarithms) tests(row++, 0) = std::exp(logarithm);
    return {.model = model, .space = *space, .tests = {tests, Eigen::VectorXd::Zero(1)}, .cloud = {.samples = 50}};
  }
  test::LinearModel model{Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1)};
  std::unique_ptr<ParameterSpace> space;
};

bool has_reason(const Verdict& verdict, const std::string& part) {
  for (const std::string& reason : verdict.reasons) {
    if (reason.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(Bounds, OnALogarithmicScaleAreStatedOnTheMedianThatTheyHold) {
  const LognormalPopulation population;
  // The logarithms have the mean 1.5 > log 3: the bound holds it at log 3.
  const UpdatingProblem problem = population.problem({0.1, 0.8, 1.5, 2.2, 2.9});
  const UpdatingResult result = MaximumLikelihoodUpdater({}).update(problem, {});
  EXPECT_NEAR(result.location()(0), 3.0, 1e-9);
  EXPECT_GT(result.mean(0), 3.5);  // exp(log 3 + v / 2) with v about 1.2 + (1.5 - log 3)^2
  const Verdict verdict = judge(problem, result);
  EXPECT_TRUE(has_reason(verdict, "The median of a (its mean is "));
  EXPECT_TRUE(has_reason(verdict, "ended on its upper bound, 3:"));
  EXPECT_FALSE(has_reason(verdict, "The mean of a ended"));
}

TEST(Bounds, AMeanBeyondABoundThatTheMedianKeepsIsOnNone) {
  const LognormalPopulation population;
  const UpdatingProblem problem = population.problem({-0.7, 0.2, 0.7, 1.2, 2.1});  // exp(0.7) = 2.01
  const UpdatingResult result = MaximumLikelihoodUpdater({}).update(problem, {});
  EXPECT_NEAR(result.location()(0), std::exp(0.7), 1e-6);
  EXPECT_EQ(population.space->active_bounds(result.location())(0), 0);
  EXPECT_FALSE(has_reason(judge(problem, result), "bound"));
}

TEST(Bounds, DoNotCutTheIntervalOfAMeanThatTheyDoNotHold) {
  const LognormalPopulation population;
  const UpdatingResult result = MaximumLikelihoodUpdater({}).update(population.problem({0.1, 0.8, 1.5, 2.2, 2.9}), {});
  ASSERT_TRUE(result.intervals);
  EXPECT_GT(result.intervals->mean(0, 1), result.mean(0));
}

}  // namespace
}  // namespace mottle::updating
