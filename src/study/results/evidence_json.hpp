// The comparison of evidences as JSON.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/jobs/compare.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// Puts ln_evidence, ln_bayes_factor with its strength, and probability of one of several models into `json`.
void add_evidence_among(const EstimatedEvidence& evidence, const ModelProbability& against, Json& json);

/// {models[], not_compared[] {label, reason}, warnings[], scale}; null where no run has an evidence.
Json evidence_comparison_json(const Comparison& comparison);

}  // namespace mottle::study
