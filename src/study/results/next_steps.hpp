// What to do after an update: for each cause of a verdict, and in all.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "study/results/verdict_summary.hpp"

namespace mottle::study {

NextStep checked_tests(const SummarySources& sources, const TestDoubt& doubt);
/// @param specimens  their numbers
NextStep without_specimens(const SummarySources& sources, const std::vector<int>& specimens);
NextStep other_population(const SummarySources& sources, bool has_batches);
NextStep more_starts(const SummarySources& sources);
NextStep more_iterations(const SummarySources& sources);
NextStep diagnosis(const SummarySources& sources);
NextStep stated_noise(const SummarySources& sources);
NextStep population_method(const SummarySources& sources);
NextStep further_outputs(const SummarySources& sources);

/// Those of the causes, then what else is left to do; at least one, the first is the most useful.
std::vector<NextStep> next_steps(const SummarySources& sources, const std::vector<VerdictCause>& causes);

/// An entry of `next` in result.json.
Json step_json(const NextStep& step);

}  // namespace mottle::study
