// The summary of an update.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/update.hpp"
#include "study/results/verdict_summary.hpp"

namespace mottle::study {

/// The verdict in words, as the first screen has it.
VerdictSummary first_screen(const UpdateOutcome& outcome, const Agreement& agreement);

/// The verdict, its causes and reasons, and what was not tested or could hide.
std::vector<std::string> verdict_lines(const UpdateOutcome& outcome);

}  // namespace mottle::study
