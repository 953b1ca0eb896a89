// What `abc` says of its estimate: intervals, draws, comparison with a likelihood, notes.
#pragma once

#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/methods/abc_sampling.hpp"

namespace mottle::updating {

/// What the estimate was made from.
struct AbcFit {
  const UpdatingProblem& problem;
  const ScaledParameters& parameters;
  const PopulationCoordinates& coordinates;
  const NearestPopulation& nearest;
  const AbcOptions& options;
  bool has_correlations = true;
  std::vector<bool> is_seen;  ///< whether the outputs determine each parameter [parameter]
};

/// Parameters that the outputs determine: all but those with more than a tenth of their length, in prior standard
/// deviations, along combinations that move the outputs by less than a thousandth of what the strongest one does.
///
/// @param sensitivity  dy/dt [output x parameter]
/// @param unit         size of a difference in each output [output]
std::vector<bool> seen_parameters(const ScaledParameters& parameters,
                                  const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                                  const Eigen::Ref<const Eigen::VectorXd>& unit);

/// Intervals of means, standard deviations and correlations, findings and notes, into the result, whose estimate is
/// known.
void describe_abc(const AbcFit& fit, const SampledPopulations& sampled, UpdatingResult& result);

}  // namespace mottle::updating
