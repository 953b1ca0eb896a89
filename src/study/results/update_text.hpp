// An update in words.
#pragma once

#include <string>
#include <vector>

#include "mottle/study/jobs/update.hpp"

namespace mottle {

/// The verdict, its reasons, and what was not tested or could hide.
std::vector<std::string> verdict_lines(const UpdateOutcome& outcome);

}  // namespace mottle
