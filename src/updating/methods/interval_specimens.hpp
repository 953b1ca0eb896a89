// Parameters of its own for each specimen of `interval`, and what they leave of its tests.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/specimen_bounds.hpp"

namespace mottle::updating {

/// What stays the same through all steps.
struct IntervalSetup {
  const UpdatingProblem& problem;
  const RunContext& context;
  TestMoments tests;
  SpecimenBounds bounds;
  Eigen::VectorXd prior_std;
};

/// Specimens and the two vectors of limits, each fitted by parameters of its own.
struct OwnParameters {
  Eigen::MatrixXd specimens;  ///< [specimen x parameter]
  ParameterBox hull;          ///< of the specimens'
  ParameterBox of_limits;     ///< of those of the two vectors of limits
  Eigen::MatrixXd residuals;  ///< z - f [specimen x output]
  Eigen::MatrixXd unbounded;  ///< the same where no bound holds a parameter
  std::vector<int> ranks;     ///< of each specimen
};

/// Fits every specimen, and the two vectors of limits, by parameters within the bounds.
OwnParameters fit_own_parameters(const IntervalSetup& setup, std::int64_t& evaluations);

}  // namespace mottle::updating
