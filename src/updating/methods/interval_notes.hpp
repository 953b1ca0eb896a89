// What a reader of a box of parameters must know, in sentences.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "updating/methods/covering_box.hpp"

namespace mottle::updating {

/// Status and message of the search.
void describe_ending(const CoveringBox& covering, const CoverTask& task, UpdatingResult& result);

/// Ends of the box that are not the only ones of its measure, and parameters without width that `allowed` gives one.
std::vector<std::string> undetermined_ends(const UpdatingProblem& problem, const ParameterBox& allowed,
                                           const CoveringBox& covering);

/// Notes and warnings on bounds, image and box.
///
/// @param crossing  outputs whose modes may cross in the box
void add_interval_notes(const UpdatingProblem& problem, const IntervalResult& found,
                        const std::vector<std::string>& crossing, UpdatingResult& result);

}  // namespace mottle::updating
