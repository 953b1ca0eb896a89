// What of a verdict comes from specimens that are not like the others.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "study/results/verdict_summary.hpp"

namespace mottle::study {

/// Outliers; else, where the model is refused, at most a quarter of the specimens that have residuals less probable
/// than the verdict's level over their number (chi-squared of the whitened residuals); then populations that are not
/// normal.
void add_causes_of_specimens(const SummarySources& sources, std::vector<VerdictCause>& causes);

}  // namespace mottle::study
