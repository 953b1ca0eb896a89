#include "updating/methods/moment_matching.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using Rule = MomentMatchingOptions::Rule;
using test::frequencies_of;
using test::oracle_parameters;
using test::standard_deviations;
using test::ThreeMasses;

UpdatingResult update(const UpdatingProblem& problem, const MomentMatchingOptions& options = {}) {
  return MomentMatchingUpdater(options).update(problem, {.seed = 1});
}

/// y = x^2 of one parameter: mean mu^2 + s^2, variance 4 mu^2 s^2 + 2 s^4, in closed form.
class Square final : public Model {
 public:
  Eigen::Index parameter_count() const override { return 1; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    Evaluation evaluation;
    evaluation.outputs = samples.cwiseAbs2();
    return evaluation;
  }

 private:
  std::vector<Quantity> outputs_{named_quantity("y", "-")};
};

TEST(MomentMatching, ReproducesTheQuadratureSolutionOfTheThreeMasses) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-8;
  problem.iterations = 100;
  const UpdatingResult result = update(problem);
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // validation/reference-rows: Gaussian moment matching by quadrature.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.07780753, 1.09323337, 0.96010173)).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.28967961, 0.11086464, 0.23698861)).cwiseAbs().maxCoeff(),
            1e-6);
}

TEST(MomentMatching, EveryRuleComesToTheSamePopulation) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.cloud = {.samples = 16384, .design = SamplingDesign::sobol};
  problem.iterations = 100;
  for (const Rule rule : {Rule::gauss_hermite, Rule::fifth_degree, Rule::cloud}) {
    const UpdatingResult result = update(problem, {.rule = rule});
    EXPECT_LT((result.mean - Eigen::Vector3d(1.07780753, 1.09323337, 0.96010173)).cwiseAbs().maxCoeff(), 2e-3);
    EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.28967961, 0.11086464, 0.23698861)).cwiseAbs().maxCoeff(),
              2e-3);
  }
}

TEST(MomentMatching, HasTheClosedFormOfASquare) {
  const Square model;
  const Distribution prior({.kind = DistributionKind::normal, .mean = 4.0, .std = 0.5});
  const ParameterSpace space({{"x", "-"}}, JointDistribution({prior}));
  Eigen::MatrixXd tests(4, 1);
  tests << 7.0, 9.0, 12.0, 10.0;
  const double mean = 9.5;
  const double variance = (6.25 + 0.25 + 6.25 + 0.25) / 3.0;
  const UpdatingResult result = update({.model = model,
                                        .space = space,
                                        .tests = {tests, Eigen::VectorXd::Constant(1, 0.2)},
                                        .iterations = 100,
                                        .tolerance = 1e-10});
  // With a = mu^2, b = s^2: a + b = mean, 4 a b + 2 b^2 = variance - noise: b = mean - sqrt(mean^2 - (variance - r)/2).
  const double b = mean - std::sqrt(mean * mean - 0.5 * (variance - 0.04));
  EXPECT_NEAR(result.mean(0), std::sqrt(mean - b), 1e-7);
  EXPECT_NEAR(result.covariance(0, 0), b, 1e-7);
}

TEST(MomentMatching, OnTheLogarithmOfASquareIsItsClosedForm) {
  // ln y = 2 t: y is log-normal, and the moments of t = ln x follow from its mean and variance.
  const Square model;
  const Distribution prior({.kind = DistributionKind::normal, .mean = 3.0, .std = 0.5});
  const Parameter parameter{.name = "x", .unit = "-", .transform = {ParameterTransform::Kind::log}};
  const ParameterSpace space({parameter}, JointDistribution({prior}));
  Eigen::MatrixXd tests(4, 1);
  tests << 7.0, 9.0, 12.0, 10.0;
  const double log_variance = std::log1p((13.0 / 3.0) / (9.5 * 9.5)) / 4.0;
  const double log_mean = (std::log(9.5) - 2.0 * log_variance) / 2.0;
  const UpdatingResult result = update({.model = model,
                                        .space = space,
                                        .tests = {tests, Eigen::VectorXd::Zero(1)},
                                        .iterations = 100,
                                        .tolerance = 1e-10},
                                       {.points = 20});
  const double expected_mean = std::exp(log_mean + 0.5 * log_variance);
  EXPECT_NEAR(result.mean(0), expected_mean, 1e-7);
  EXPECT_NEAR(result.covariance(0, 0), expected_mean * expected_mean * std::expm1(log_variance), 1e-7);
}

}  // namespace
}  // namespace mottle::updating
