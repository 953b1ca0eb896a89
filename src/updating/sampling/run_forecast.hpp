// How many likelihoods islands will have asked for when they reach the posterior.
#pragma once

#include <cstdint>
#include <optional>

#include "mottle/layers.hpp"
#include "updating/sampling/island_batches.hpp"

namespace mottle::updating {

/// Expected number of likelihoods from prior to posterior, with those that were asked for already: the stages that are
/// missing if the exponent goes on to grow as in the last stage, each with as many moves as the last ones took. Nothing
/// before every island has finished a stage.
///
/// @param asked_for  likelihoods until now
std::optional<double> expected_evaluations(const Islands& islands, const SamplingSettings& settings,
                                           std::int64_t asked_for);

}  // namespace mottle::updating
