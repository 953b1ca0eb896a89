// The population behind given tests: the alternation of specimens' fits and a linear random-effects estimate, without
// clouds. What `maximum-likelihood`, its bootstrap and the diagnosis have in common.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/sample_region.hpp"
#include "mottle/stats/population/random_effects.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/fits/specimen_fit.hpp"
#include "updating/population/noise_levels.hpp"

namespace mottle::updating {

struct PopulationFitSettings {
  NoiseModel noise;
  /// Noise that is not known is estimated from residuals, see noise_levels.hpp; false: one level for each kind of
  /// output, together with the population.
  bool has_noise_of_residuals = true;
  NoiseModel model_error = {};  ///< of errors that all specimens share; `base` empty: none
  bool is_restricted = true;
  double rank_tolerance = 1e-3;
  int iterations = 30;
  double tolerance = 1e-3;
  double specimen_tolerance = 1e-8;  ///< of the specimens' own fits, in prior standard deviations
  int inner_iterations = 300;  ///< of the linear problem, each time it is solved; it goes on from the last solution
  /// Parameters whose specimens all share one value; needs the problem's covariance_groups. Empty: all scatter.
  std::vector<bool> has_scatter = {};
  /// The mean, on the scales, that stands for the prior's: where the fit starts and where unseen directions stay.
  Eigen::VectorXd start = {};
  /// Where the fit of the tests' mean starts, on the scales; empty: at `start`, or the prior's mean.
  Eigen::VectorXd first = {};
  /// Once the population rests, how often its specimens' fits are begun again from elsewhere (restart_specimens()), as
  /// long as one of them comes out better.
  int restarts = 0;
  /// Where the specimens are known to lie; null: the model follows the iterate.
  std::shared_ptr<const SampleRegion> region = nullptr;
};

/// An estimated population on the parameters' scales.
struct PopulationFit {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd noise;  ///< variance of each output
  /// Where the noise is estimated and residuals are left to estimate it from; else without degrees of freedom
  NoiseOfResiduals noise_of_residuals = {};
  std::optional<ModelError> model_error;
  Eigen::MatrixXd seen;  ///< orthonormal directions, in prior deviations, that the outputs see [parameter x rank]
  Eigen::MatrixXd map;   ///< parameters of effects [parameter x effect]
  SpecimenFits specimens;
  std::vector<RandomEffectsUnit> units;  ///< the last linear problem, in effects
  RandomEffectsSettings settings;        ///< and how it was solved
  RandomEffectsFit effects;
  Eigen::MatrixXd sensitivity;  ///< mean of df/dt over the specimens [output x parameter]
  int iterations = 0;
  bool converged = false;
  std::int64_t evaluations = 0;
  std::shared_ptr<const SampleRegion> region;  ///< to which the model was adapted at last; null: to none
  Eigen::VectorXd unbounded_mean;              ///< of the last linear problem, if no bound held it
  double unbounded_log_likelihood = 0.0;       ///< there
};

/// Whether the noise of any output is estimated.
bool is_noise_estimated(const PopulationFit& fit);

/// Means of the measured values of each output.
Eigen::RowVectorXd means_of_tests(const Eigen::Ref<const Eigen::MatrixXd>& values);

/// What the specimens show of a fitted population.
PopulationEvidence evidence_of(const PopulationFit& fit);

/// @param values      tests [specimen x output], nan: missing
/// @param each        called with the state after every iteration; returns false to stop
/// @throws as fit_specimens and fit_random_effects
PopulationFit fit_population(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                             const PopulationFitSettings& settings, const RunContext& context,
                             const std::function<bool(const PopulationFit&)>& each);

}  // namespace mottle::updating
