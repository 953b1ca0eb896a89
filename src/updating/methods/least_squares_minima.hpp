// The minima of a least-squares problem.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/methods/least_squares.hpp"

namespace mottle::updating {

/// Minimises J(x) from the prior's mean x0 and from every solution of the test without a prior (find_mean_solutions()).
/// Returns where a descent to the lowest minimum starts: x0 if that leads there, else the minimum itself. Others x'
/// become `other_solutions`, the lowest first, where J(x') is within c of the lowest, c the 1 - level quantile of
/// chi-squared with as many degrees of freedom as parameters, and where they are apart: by more than a tenth of a prior
/// standard deviation, and with a' G'WG a > c for the difference a. Their weights are exp(-J / 2), relative.
///
/// A start where the model fails, or from which `iterations` steps do not suffice, finds nothing.
///
/// @param result  its first state holds the prior's cloud; `model_evaluations`, `search` and `other_solutions` change
Eigen::VectorXd start_at_lowest(const UpdatingProblem& problem, const LeastSquares& setup, const RunContext& context,
                                UpdatingResult& result);

}  // namespace mottle::updating
