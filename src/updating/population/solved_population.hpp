// The population behind given tests, looked for about every solution of their mean.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/mean_solutions.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// A population about one solution of the mean.
struct PopulationSolution {
  MeanSolution mean;
  PopulationFit fit;
  double log_weight = 0.0;  ///< plain log-likelihood of the linearised problem, and log-density of the prior at the
                            ///< mean; constants are left out
};

struct SolvedPopulation {
  std::vector<PopulationSolution> solutions = {};  ///< greatest weight first
  PopulationFitSettings settings = {};             ///< with which the first was fitted
  int starts = 0;                                  ///< of the search for the mean's solutions

  const PopulationFit& best() const { return solutions.front().fit; }
};

/// Of the linear problem at the fit; unlike the restricted likelihood comparable between linear problems.
double plain_log_likelihood(const PopulationFit& fit);

/// The population fitted from each of the mean's solutions, eight at most, greatest weight first. A fit in which the
/// model fails is left out.
/// @throws SystemFailure  all do
std::vector<PopulationSolution> fit_solutions(const UpdatingProblem& problem, const PopulationFitSettings& settings,
                                              const MeanSolutions& means, const RunContext& context,
                                              std::int64_t& evaluations);

/// Searches for the solutions of the tests' mean (find_mean_solutions(), in the prior's cloud too), fits the population
/// from each, and weighs them: the likelihood of the tests times the density of the prior, taken as normal on the
/// parameters' scales, at the population's mean. Where the prior's mean leads to a solution the fit starts there.
///
/// @param each    called with the state of the best one's fit after every iteration; returns false to stop
/// @throws as fit_population, where no fit succeeds
SolvedPopulation solve_population(const UpdatingProblem& problem, const PopulationFitSettings& settings,
                                  const Cloud& prior_cloud, const RunContext& context,
                                  const std::function<bool(const PopulationFit&)>& each, std::int64_t& evaluations);

}  // namespace mottle::updating
