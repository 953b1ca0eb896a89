// What to run after an update.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "study/results/verdict_summary.hpp"

namespace mottle::study {

/// At least one step; the first is the most useful.
std::vector<NextStep> next_steps(const SummarySources& sources);

}  // namespace mottle::study
