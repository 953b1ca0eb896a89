// What the page draws of a sampled posterior: ranks of the chains' draws, and intervals of outputs and further tests.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// {bins, expected_range[2], counts[name][chain][bin]}: of the ranks among the draws of all chains that those of each
/// chain have, in equal bins; all alike where chains agree. The range holds a count of as many independent draws in
/// 95 % of cases.
/// Source: [Vehtari2021], section 5.
Json rank_histograms(const SampledPosterior& posterior);

/// {probabilities[], outputs[output][], tests[output][]}: quantiles over the draws of the model's outputs and of
/// further tests with noise and model error; null where they are not known.
Json predictive_quantiles(const SampledPosterior& posterior);

}  // namespace mottle::study
