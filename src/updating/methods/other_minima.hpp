// Other minima of a least-squares problem, from starting points drawn from the prior.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/methods/least_squares.hpp"

namespace mottle::updating {

/// Minimises J(x) again from `starts` points and puts into the result the minima x' that are apart from the estimate x
/// and from one another: by more than a tenth of a prior standard deviation, and with a' G'WG a > c for a = x' - x. Of
/// them, with c the 1 - level quantile of chi-squared with as many degrees of freedom as parameters,
///
///   J(x') < J(x) - c:   `better_solution`, the lowest; the estimate is a local minimum, which message and notes say;
///   |J(x') - J(x)| <= c: `other_solutions`, the nearest to the estimate first.
///
/// Starts lie in a Latin hypercube of the prior stretched to twice its deviations, within bounds and physical limits. A
/// start where the model fails, or from which `iterations` steps do not suffice, finds nothing.
///
/// @param estimate  a minimum of J
/// @param result    `model_evaluations` is raised
void find_other_minima(const UpdatingProblem& problem, const LeastSquares& setup, const LeastSquaresPoint& estimate,
                       int starts, const RunContext& context, UpdatingResult& result);

}  // namespace mottle::updating
