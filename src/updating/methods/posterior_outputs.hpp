// What the model gives at the draws of a posterior of common parameters: outputs, further tests, and how probable each
// specimen is.
#pragma once

#include <cstdint>

#include "mottle/layers.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "updating/methods/common_likelihood.hpp"

namespace mottle::updating {

/// Runs the model at each draw. A further test of a draw x is f(x) + d + e with d of N(0, D) given x and the tests, e
/// of N(0, R). Specimens are independent given x where the model has no error d of its own.
///
/// @return  model runs
std::int64_t add_outputs(const UpdatingProblem& problem, const NoiseLevels& noise, const CommonLikelihood& likelihood,
                         const RunContext& context, SampledPosterior& posterior);

/// Names the specimens whose leave-one-out density is not to be relied on.
void note_specimens(const TestData& tests, const SampledPosterior& posterior, UpdatingResult& result);

}  // namespace mottle::updating
