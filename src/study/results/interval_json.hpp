// What result.json says of a box of parameters.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// `interval` and `parameters.box`; null where the method finds no box.
void add_interval(const UpdatingProblem& problem, const IntervalResult* interval, Json& result);

/// Bounds of the tests, image and what is proven, in sentences.
std::vector<std::string> interval_sentences(const UpdatingProblem& problem, const IntervalResult& interval);

}  // namespace mottle::study
