// The study that `mottle init` proposes, as text with its reasons.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"

namespace mottle::study {

/// TOML with comments: what was found, what was guessed, what is not known.
std::string study_text_of(const InitOutcome& outcome);

}  // namespace mottle::study
