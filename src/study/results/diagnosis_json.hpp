// The contents of diagnosis.json.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/jobs/diagnose.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// The set that a diagnosis proposes.
Json proposed_json(const Diagnosis& diagnosis);

/// All of diagnosis.json but timings and ranks.
Json diagnosis_json(const DiagnoseOutcome& outcome);

}  // namespace mottle::study
