// A sampled posterior in files: its draws as a table and in ArviZ's layout, and what result.json says of it.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// posterior.csv: chain and draw from 1, parameters and levels of the noise, log-likelihood.
std::string posterior_csv(const SampledPosterior& posterior);

/// posterior.json: groups of variables, each a list [chain][draw], and the tests, as ArviZ's from_json() reads them.
std::string posterior_arviz(const SampledPosterior& posterior, const UpdatingProblem& problem);

/// `evidence`, `posterior` and `modes` of result.json; null, null and none where the method samples no posterior.
void add_posterior(const SampledPosterior* posterior, const TestData& tests, Json& result);

}  // namespace mottle::study
