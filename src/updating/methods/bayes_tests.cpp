#include "updating/methods/bayes_tests.hpp"

#include <cmath>
#include <limits>

#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/methods/mean_limits.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {
namespace {

void plan_residuals(const UpdatingProblem& problem, const Eigen::VectorXd& residual, const Eigen::VectorXd& variance,
                    const PosteriorPeak& peak, TestPlan& plan) {
  const Eigen::MatrixXd b = unmoved_directions(peak.sensitivity, variance.cwiseSqrt(),
                                               problem.space.prior().covariance().diagonal().cwiseSqrt());
  const auto d = static_cast<double>(b.cols());
  if (d == 0.0) {
    plan.leave_untested_for_lack_of_outputs(
        Aspect::means, fmt::format("The outputs were not tested: {} of them are no more than the identifiable "
                                   "combinations of parameters, so the residuals cannot tell whether the model is "
                                   "right. {}",
                                   residual.size(), k_more_outputs));
    return;
  }
  const Eigen::VectorXd rest = b.transpose() * residual;
  const Eigen::MatrixXd covariance = b.transpose() * variance.asDiagonal() * b;
  PlannedTest test = chi_squared_test("residuals", rest.dot(solve_semidefinite(covariance, rest)), d);
  test.aspect = Aspect::means;
  test.meaning = fmt::format(
      "Chi-squared with {:.0f} degrees of freedom: are the residuals of the outputs, in the directions that no "
      "parameter moves, no larger than noise and model error?",
      d);
  test.power = [=](double level) {
    return Power{fmt::format("outputs that are off by {:.2g} standard deviations of the tests' mean in one of them",
                             std::sqrt(chi_squared_detectable(d, level)))};
  };
  plan.add(std::move(test));
}

void plan_specimens(const CommonLikelihood& likelihood, const Eigen::VectorXd& variances, TestPlan& plan) {
  const double d = (likelihood.count().array() - 1.0).sum();
  if (d <= 0.0) return;  // one specimen
  PlannedTest test = chi_squared_test("specimens", likelihood.scatter().cwiseQuotient(variances).sum(), d);
  test.aspect = Aspect::scatter;
  test.meaning = fmt::format(
      "Chi-squared with {:.0f} degrees of freedom: do the specimens differ by no more than the measurement noise, as "
      "they must where all have the same parameters?",
      d);
  test.power = [=](double level) {
    return Power{fmt::format("a scatter of the specimens of {:.2g} times the noise",
                             std::sqrt(chi_squared_detectable(d, level) / d))};
  };
  plan.add(std::move(test));
}

/// Where the tests put the parameters if no bound holds them, to first order from the peak.
FreeMean free_mean(const UpdatingProblem& problem, const Eigen::VectorXd& residual, const Eigen::VectorXd& variance,
                   const PosteriorPeak& peak) {
  const ScaledParameters parameters(problem.space);
  const Eigen::VectorXd point = from_variables(parameters.scales(), peak.parameters.transpose()).row(0).transpose();
  const Eigen::MatrixXd g = peak.sensitivity * parameters.slopes(point).asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(point.size(), point.size());
  const Eigen::MatrixXd prior = solve_semidefinite(parameters.covariance(), identity);
  const Eigen::MatrixXd gw = g.transpose() * variance.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd covariance = solve_semidefinite(gw * g + prior, identity);
  const Eigen::VectorXd step = covariance * (gw * residual - prior * (point - parameters.start()));
  return {point + step, 0.5 * (covariance + covariance.transpose()), std::numeric_limits<double>::infinity()};
}

}  // namespace

void test_posterior(const UpdatingProblem& problem, const CommonLikelihood& likelihood, const NoiseLevels& noise,
                    const PosteriorPeak& peak, UpdatingResult& result) {
  TestPlan plan;
  const Eigen::VectorXd variances = result.noise_covariance.diagonal();
  const Eigen::VectorXd variance = likelihood.variance_of_mean(variances);
  const Eigen::VectorXd residual = likelihood.mean() - peak.outputs;
  if (noise.is_known()) {
    plan_residuals(problem, residual, variance, peak, plan);
    plan_specimens(likelihood, variances, plan);
  } else {
    plan.leave_untested(Aspect::means,
                        "The outputs were not tested: their noise is estimated, and takes in what the model cannot "
                        "explain. Give [test] repeatability.");
    if (problem.tests.values.rows() > 1) {
      plan.leave_untested(Aspect::scatter,
                          "The scatter was not tested: the noise is estimated, and takes in what the specimens differ "
                          "by. Give [test] repeatability.");
    }
  }
  const FreeMean free = free_mean(problem, residual, variance, peak);
  plan_bound_test(problem, free, plan);
  plan_prior_shift(problem, free.mean, free.covariance, plan);
  plan.make(problem.level, result);
}

}  // namespace mottle::updating
