// What a verdict comes from, and what else a reader of the estimate must know at once: the first lines of every screen.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "study/results/verdict_summary.hpp"

namespace mottle::study {

/// The most useful to look at first: doubtful tests, specimens that do not belong to the others, a population that is
/// not normal, modes that cross; then tests that refuse the model; then what keeps the verdict from being decided.
/// Empty: nothing of these.
std::vector<VerdictCause> find_causes(const SummarySources& sources);

}  // namespace mottle::study
