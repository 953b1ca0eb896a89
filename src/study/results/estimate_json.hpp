// Data of an estimate for the page: densities, quantiles, correlations and regions of pairs.
#pragma once

#include "mottle/layers.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// Adds to the parameters of result.json what docs/reference/result-json.md calls `estimate`, `quantiles`, `densities`,
/// `correlation` and `regions`.
void add_estimate(const UpdatingProblem& problem, const UpdatingResult& result, Json& parameters);

/// Numbers with six digits of their range: enough to draw them.
Json drawn_json(const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace mottle::study
