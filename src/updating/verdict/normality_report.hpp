// What the specimens' own estimates say of the population's shape, put into words: a remark, not evidence against the
// model.
#pragma once

#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Tests the population at the problem's level; says in the result's notes what is not normal and what may be done.
/// `result.outliers` must be known.
void report_normality(const UpdatingProblem& problem, const PopulationFit& fit, UpdatingResult& result);

/// For each parameter the scale on which its specimens' estimates look normal, with twice the p-value that they have
/// on its own and p > 0.05; nothing where there is none.
std::vector<std::optional<ParameterTransform>> more_normal_scales(const UpdatingProblem& problem,
                                                                  const PopulationFit& fit);

}  // namespace mottle::updating
