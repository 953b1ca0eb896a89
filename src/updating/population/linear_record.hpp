// A state of an iteration that evaluates no cloud.
#pragma once

#include <functional>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// One iteration without a cloud: outputs to first order from the specimens' own linear models.
IterationRecord linear_record(const UpdatingProblem& problem, const PopulationFit& fit, const TestMoments& tests);

/// What fit_population() is to call after every iteration so that `result` gets its record, and the phase of the next
/// one begins; false where the run was asked to stop. What is given must outlive it.
std::function<bool(const PopulationFit&)> record_iterations(const UpdatingProblem& problem, const TestMoments& tests,
                                                            const RunContext& context, UpdatingResult& result);

}  // namespace mottle::updating
