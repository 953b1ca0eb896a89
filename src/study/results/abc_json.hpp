// Approximate Bayesian computation in result.json, and its draws as a table.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/abc.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// Adds what docs/reference/result-json.md calls `abc`; null where the method is another one.
void add_abc(const AbcFindings* found, Json& result);

/// posterior.csv: chain and draw from 1, then means, standard deviations, correlations and levels of the noise.
std::string abc_csv(const AbcFindings& found);

}  // namespace mottle::study
