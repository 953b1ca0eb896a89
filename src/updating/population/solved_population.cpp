#include "updating/population/solved_population.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

constexpr std::size_t k_most_fits = 8;
constexpr int k_restarts = 3;

double prior_log_density(const PriorOnScales& prior, const Eigen::VectorXd& point) {
  const Eigen::VectorXd away = point - prior.mean;
  return -0.5 * away.dot(solve_semidefinite(prior.covariance, away));
}

/// The only solution is come to from the prior's mean, where that leads to it. Of several, each fit starts at its own:
/// from the prior's mean, where like parameters are equal, a fit can stay on the saddle between them.
PopulationFitSettings settings_from(const PopulationFitSettings& settings, const MeanSolution& solution, bool is_only) {
  PopulationFitSettings own = settings;
  if (!is_only || !solution.is_from_prior) own.first = solution.point;
  return own;
}

/// Where the noise or the model's error is to be estimated, with what it is estimated from.
MeanSearchSettings search_settings(const UpdatingProblem& problem, const PopulationFitSettings& settings) {
  MeanSearchSettings search = mean_search_settings(problem);
  const Eigen::VectorXd count = test_moments(problem.tests).count.cast<double>();
  search.noise = settings.noise.base.cwiseQuotient(count);
  if (settings.model_error.base.size() > 0) search.noise += settings.model_error.base;
  if (problem.tests.is_model_error_estimated) search.variance += settings.model_error.base;
  return search;
}

PopulationSolution fit_about(const UpdatingProblem& problem, const PopulationFitSettings& settings,
                             const MeanSolution& mean, const RunContext& context, std::int64_t& evaluations,
                             const std::function<bool(const PopulationFit&)>& each) {
  PopulationSolution solution{.mean = mean,
                              .fit = fit_population(problem, problem.tests.values, settings, context, each)};
  evaluations += solution.fit.evaluations;
  solution.log_weight =
      plain_log_likelihood(solution.fit) + prior_log_density(prior_on_scales(problem.space), solution.fit.mean);
  return solution;
}

}  // namespace

double plain_log_likelihood(const PopulationFit& fit) {
  std::vector<RandomEffectsUnit> units = fit.units;
  for (RandomEffectsUnit& unit : units) {
    unit.noise = noise_of(unit, fit.effects.noise_factors);
    unit.factor.clear();
  }
  RandomEffectsSettings settings = fit.settings;
  settings.is_restricted = false;
  settings.factors = 0;
  settings.iterations = 0;
  if (fit.model_error) settings.shared_variance = fit.model_error->std.cwiseAbs2();
  settings.shared_level.clear();
  settings.levels = 0;
  return fit_random_effects(units, fit.effects.covariance, settings).log_likelihood;
}

std::vector<PopulationSolution> fit_solutions(const UpdatingProblem& problem, const PopulationFitSettings& settings,
                                              const MeanSolutions& means, const RunContext& context,
                                              std::int64_t& evaluations) {
  std::vector<PopulationSolution> solutions;
  std::string reason;
  for (std::size_t k = 0; k < std::min(means.solutions.size(), k_most_fits); ++k) {
    try {
      const MeanSolution& mean = means.solutions[k];
      solutions.push_back(fit_about(problem, settings_from(settings, mean, means.solutions.size() == 1), mean, context,
                                    evaluations, [&](const PopulationFit&) { return !context.stop_requested(); }));
    } catch (const ModelFailure& failure) {
      reason = failure.what();
    }
  }
  if (solutions.empty()) throw ModelFailure(reason);
  std::ranges::stable_sort(solutions, std::greater(), &PopulationSolution::log_weight);
  return solutions;
}

SolvedPopulation solve_population(const UpdatingProblem& problem, const PopulationFitSettings& settings,
                                  const Cloud& prior_cloud, const RunContext& context,
                                  const std::function<bool(const PopulationFit&)>& each, std::int64_t& evaluations) {
  context.phase({.name = "search for the parameters of the tests' mean"});
  const MeanSolutions means =
      find_mean_solutions(problem, means_of_tests(problem.tests.values), search_settings(problem, settings),
                          prior_cloud, context, evaluations);
  SolvedPopulation solved{.settings = settings, .starts = means.starts};
  if (problem.starts > 0) solved.settings.restarts = k_restarts;
  if (means.solutions.size() > 1) {
    solved.solutions = fit_solutions(problem, solved.settings, means, context, evaluations);
  }
  // Once more for those who follow its iterations.
  const MeanSolution first = means.solutions.size() > 1 ? solved.solutions.front().mean : means.solutions.front();
  solved.settings = settings_from(solved.settings, first, means.solutions.size() == 1);
  PopulationSolution best = fit_about(problem, solved.settings, first, context, evaluations, each);
  if (solved.solutions.empty()) solved.solutions.resize(1);
  solved.solutions.front() = std::move(best);
  return solved;
}

}  // namespace mottle::updating
