// Evidences of several results: which of them can be compared, and what they say.
#pragma once

#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/compare.hpp"

namespace mottle::study {

/// Compares the evidences of those runs whose tests are those of the first run that has one. Nothing where no run has.
///
/// @throws InvalidInput  a file of a result cannot be read
std::optional<EvidenceComparison> compare_evidence_of(const std::vector<ComparedRun>& runs);

}  // namespace mottle::study
