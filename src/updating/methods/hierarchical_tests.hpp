// Tests of a population's posterior, on the linear problem of its specimens.
#pragma once

#include "mottle/layers.hpp"
#include "updating/methods/hierarchical_report.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// The linear problem of the specimens in the typical population, as maximum-likelihood has it.
///
/// @param result  with its estimate, noise and model error
PopulationFit as_population_fit(const HierarchicalFindings& findings, const UpdatingResult& result);

/// Puts into the result `mean-residuals` and `scatter-of-residuals` where the noise is known, `scatter-agreement`,
/// `bounds` and `prior-shift`.
///
/// @param fit  as_population_fit()
void test_hierarchical(const HierarchicalFindings& findings, const PopulationFit& fit, const RunContext& context,
                       UpdatingResult& result);

}  // namespace mottle::updating
