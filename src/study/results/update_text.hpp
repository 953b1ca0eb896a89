// The summary of an update.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/update.hpp"

namespace mottle::study {

/// The verdict, its reasons, and what was not tested or could hide.
std::vector<std::string> verdict_lines(const UpdateOutcome& outcome);

}  // namespace mottle::study
