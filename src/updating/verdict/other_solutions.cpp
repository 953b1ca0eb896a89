#include "updating/verdict/other_solutions.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/population/mean_intervals.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

/// The metric in which two means count as the same: the sampling covariance of the mean test, and what it leaves of the
/// parameters in the directions that the outputs see.
struct MeanMetric {
  Eigen::MatrixXd precision;   // of the mean test [output x output]
  Eigen::MatrixXd covariance;  // of the estimate along the seen directions, in prior deviations [direction x direction]

  double misfit(const Eigen::VectorXd& residual) const { return residual.dot(precision * residual); }
};

/// M = (G Sigma G' + R) / n + D. A part in a million of what the prior moves an output keeps it regular.
MeanMetric metric_of(const PopulationFit& fit, const TestData& tests, const Eigen::VectorXd& prior_std) {
  constexpr double k_smallest = 1e-6;
  const Eigen::MatrixXd moved = fit.sensitivity * prior_std.asDiagonal();
  Eigen::MatrixXd covariance = fit.sensitivity * fit.covariance * fit.sensitivity.transpose();
  covariance.diagonal() += fit.noise;
  covariance = covariance_of_tests_mean(tests, covariance);
  if (tests.is_model_error_estimated) covariance.diagonal() += fit.model_error->std.cwiseAbs2();
  covariance.diagonal() += k_smallest * k_smallest * moved.rowwise().squaredNorm();
  MeanMetric metric;
  metric.precision = inverse_by_lu(covariance);
  const Eigen::MatrixXd seen = moved * fit.seen;
  metric.covariance = inverse_by_lu(seen.transpose() * metric.precision * seen);
  return metric;
}

/// Those of the solutions but the first that explain the mean as well and lie apart from those before.
std::vector<const PopulationSolution*> apart(const UpdatingProblem& problem, const PopulationFit& estimate,
                                             const std::vector<PopulationSolution>& solutions) {
  constexpr double k_apart = 0.1;  // prior deviations: nearer solutions are one for every purpose
  const Eigen::VectorXd std = prior_on_scales(problem.space).covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd target = means_of_tests(problem.tests.values).transpose();
  const MeanMetric metric = metric_of(estimate, problem.tests, std);
  const double same = chi_squared_quantile(1.0 - problem.level, static_cast<double>(estimate.seen.cols()));
  const auto misfit = [&](const PopulationSolution& one) { return metric.misfit(one.mean.outputs - target); };
  std::vector<const PopulationSolution*> kept{&solutions.front()};
  for (std::size_t k = 1; k < solutions.size(); ++k) {
    const PopulationSolution& one = solutions[k];
    const bool is_new = std::ranges::none_of(kept, [&](const PopulationSolution* other) {
      const Eigen::VectorXd between = estimate.seen.transpose() * (one.fit.mean - other->fit.mean).cwiseQuotient(std);
      return between.cwiseAbs().maxCoeff() < k_apart ||
             between.dot(solve_semidefinite(metric.covariance, between)) <= same;
    });
    if (is_new && misfit(one) - misfit(*kept.front()) <= same) kept.push_back(&one);
  }
  return kept;
}

}  // namespace

void name_other_solutions(const UpdatingProblem& problem, const PopulationFit& estimate,
                          const std::vector<PopulationSolution>& solutions, int starts, UpdatingResult& result) {
  const std::vector<const PopulationSolution*> named = apart(problem, estimate, solutions);
  result.search = SolutionSearch{
      .starts = starts,
      .is_settled = std::ranges::all_of(named, [](const PopulationSolution* one) { return one->mean.met >= 2; })};
  double sum = 0.0;
  const auto relative = [&](const PopulationSolution& one) {
    return std::exp(one.log_weight - named.front()->log_weight);
  };
  for (const PopulationSolution* one : named) sum += relative(*one);
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  for (std::size_t k = 1; k < named.size(); ++k) {
    const PopulationFit& fit = named[k]->fit;
    const VariableMoments moments = moments_of_variables(scales, fit.mean, fit.covariance);
    result.other_solutions.push_back({.mean = moments.mean,
                                      .std = moments.covariance.diagonal().cwiseSqrt(),
                                      .mean_interval = analytic_intervals(problem, fit).mean,
                                      .weight = relative(*named[k]) / sum});
  }
}

BestStart start_at_best(const UpdatingProblem& problem, const RunContext& context, std::int64_t& evaluations,
                        UpdatingResult& result) {
  constexpr double k_kept = 0.01;  // of the prior's variance
  PriorOnScales start = prior_on_scales(problem.space);
  if (context.stop_requested()) return {start, {}};
  const MeanSolutions means = find_mean_solutions(problem, result.history.front().cloud, context, evaluations);
  result.search = SolutionSearch{.starts = means.starts, .is_settled = means.solutions.front().met >= 2};
  if (means.solutions.size() == 1 && means.solutions.front().is_from_prior) {
    return {start, means.solutions.front().point};
  }
  const PopulationFitSettings settings{.noise = noise_model(problem, {}),
                                       .model_error = model_error_model(problem),
                                       .iterations = problem.iterations,
                                       .tolerance = problem.tolerance};
  const std::vector<PopulationSolution> solutions = fit_solutions(problem, settings, means, context, evaluations);
  const PopulationSolution& best = solutions.front();
  name_other_solutions(problem, best.fit, solutions, means.starts, result);
  if (solutions.size() == 1 && best.mean.is_from_prior) return {start, best.mean.point};
  start.mean = best.fit.mean;
  start.covariance = best.fit.covariance + k_kept * start.covariance;
  return {start, best.mean.point};
}

}  // namespace mottle::updating
