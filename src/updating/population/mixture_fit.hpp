// The mixture behind given tests: the alternation of specimens' fits, each held by its batch, and a mixture of linear
// random effects.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/mixture_choice.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Effects of the mixture: parameters t = origin + map x, x of about unit scatter in all specimens together.
struct MixtureFrame {
  Eigen::VectorXd origin;  ///< the mean of all specimens taken as one batch [parameter]
  Eigen::MatrixXd map;     ///< [parameter x effect]
  Eigen::VectorXd unit;    ///< of each effect of `fit_population` [effect]

  BatchOnScales on_scales(const MixtureComponent& component) const;
};

/// A mixture and what it stands on.
struct MixturePopulationFit {
  MixtureFrame frame;
  SpecimenFits specimens;
  MixtureData data;   ///< each specimen with its own noise
  MixtureData alike;  ///< specimens with the same outputs with their mean noise
  MixtureFit mixture;
  int iterations = 0;
  bool converged = false;
  std::int64_t evaluations = 0;
};

/// The linear problem at the fit of one population, without batches yet. Where specimens are all alike in every effect,
/// `unit` is zero.
MixturePopulationFit begin_mixture(const UpdatingProblem& problem, const PopulationFit& one);

/// Keeps the means of batches within the parameters' bounds.
std::function<Eigen::VectorXd(const Eigen::VectorXd&, const Eigen::MatrixXd&)> within_bounds(
    const UpdatingProblem& problem, const MixtureFrame& frame);

/// From the components of fit.mixture to its end. Outliers stay where one population holds them.
///
/// @param each  called after every iteration; returns false to stop
void iterate_mixture(const UpdatingProblem& problem, const PopulationFit& one, const MixtureSearch& search,
                     const RunContext& context, MixturePopulationFit& fit,
                     const std::function<bool(const MixturePopulationFit&)>& each);

/// The mixture as one population of the same moments, so that what does not depend on batches can be asked of it. Its
/// linear problem is that of the specimens as they are now.
PopulationFit as_one_population(const UpdatingProblem& problem, const PopulationFit& one,
                                const MixturePopulationFit& fit);

}  // namespace mottle::updating
