// The answer of a method that asks another question than for a mean and a scatter: batches, a box, accepted
// simulations, chains. One text for the report, the terminal and result.json.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// A few sentences on what the method itself found, the answer first; empty for methods whose answer is the verdict and
/// the table of the parameters.
std::string method_answer(const UpdatingProblem& problem, const UpdatingResult& result);

}  // namespace mottle::study
