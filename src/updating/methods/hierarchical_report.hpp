// What draws of a population's posterior say: estimate, intervals, specimens, tests, and notes in words.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/hierarchical.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/specimen_fit.hpp"
#include "updating/population/population_prior.hpp"
#include "updating/sampling/corrected_posterior.hpp"

namespace mottle::updating {

/// Draws of all islands, one below the other.
struct HierarchicalDraws {
  std::vector<PopulationAt> populations;  ///< [draw]
  Eigen::MatrixXd specimens = {};         ///< on the scales, side by side [draw x specimen * parameter]
};

/// mu of each draw, on the scales [draw x parameter].
Eigen::MatrixXd means_of(const HierarchicalDraws& draws);

/// What is said of the draws. What it refers to must outlive it.
struct HierarchicalFindings {
  const UpdatingProblem& problem;  ///< its model adapted to the specimens
  const PopulationPrior& prior;
  const NoiseLevels& noise;
  const SpecimenFits& fits;  ///< of the specimens where they were linearised
  const HierarchicalDraws& draws;
  const SampledPosterior& posterior;
};

/// Names and values of posterior.csv: population, levels of the noise, model error, and, where they are not many, the
/// parameters of each specimen, "k1:3" by its number.
struct NamedDraws {
  std::vector<std::string> names;
  Eigen::MatrixXd values = {};  ///< [draw x name]
  bool has_specimens = true;
};
NamedDraws named_draws(const UpdatingProblem& problem, const PopulationPrior& prior, const HierarchicalDraws& draws);

/// Puts the estimate into the result: the population with the posterior's mean of mu, medians of the standard
/// deviations and mean of the correlations, on the parameters' scales, and intervals of moments from all draws.
void estimate_population(const HierarchicalFindings& findings, UpdatingResult& result);

/// Puts noise, model error, specimens, tests and notes into the result, whose estimate and last state are there.
///
/// Tests: `mean-residuals` and `scatter-of-residuals` of maximum-likelihood at the specimens' linear models where the
/// noise is known, `scatter-agreement`, `bounds` and `prior-shift`.
void describe_hierarchical(const HierarchicalFindings& findings, const RunContext& context, UpdatingResult& result);

}  // namespace mottle::updating
