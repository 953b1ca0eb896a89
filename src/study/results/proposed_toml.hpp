// What a diagnosis proposes, to be pasted into the study.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/diagnose.hpp"

namespace mottle::study {

/// The proposed parameters that the study does not have yet, as [[parameter]] tables with the priors that they were
/// tried with and comments on what is to be known of them; empty: there are none.
std::string proposed_toml(const DiagnoseOutcome& outcome);

}  // namespace mottle::study
