// The comparison of evidences as JSON.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/jobs/compare.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// {models[], not_compared[] {label, reason}, warnings[], scale}; null where no run has an evidence.
Json evidence_comparison_json(const Comparison& comparison);

}  // namespace mottle::study
