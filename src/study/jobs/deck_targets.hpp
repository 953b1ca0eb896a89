// The numbers of a solved deck that can be parameters.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/jobs/targets.hpp"
#include "study/jobs/solved_deck.hpp"

namespace mottle::study {

/// See find_targets().
TargetsOutcome targets_of(const SolvedDeck& solved, const TargetsSettings& settings);

}  // namespace mottle::study
