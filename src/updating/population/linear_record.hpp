// A state of an iteration that evaluates no cloud.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// One iteration without a cloud: outputs to first order from the specimens' own linear models.
IterationRecord linear_record(const UpdatingProblem& problem, const PopulationFit& fit, const TestMoments& tests);

}  // namespace mottle::updating
