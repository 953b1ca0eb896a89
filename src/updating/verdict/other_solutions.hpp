// Whether other parameters explain the mean of the tests as well.
#pragma once

#include "mottle/layers.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Means of the parameters that explain the mean test z as well as the estimate does, found without a prior from starts
/// drawn from it (Latin hypercube). With M = (G Sigma G' + R) / n, the sampling covariance of z, a mean t explains z as
/// well where
///
///   (z - f(t))' M^-1 (z - f(t)) <= the same of the estimate + chi2_q(1 - level),
///
/// q the number of combinations that the outputs see. It is another solution where it lies within the bounds and apart
/// from the others: beyond their joint confidence ellipsoid of that level, to first order, and by more than a tenth of
/// a prior deviation in some direction that the outputs see.
///
/// @param starts  number of starts
/// @return        on the parameters' own axes [parameter], nearest to the prior first
std::vector<Eigen::VectorXd> other_solutions(const UpdatingProblem& problem, const PopulationFit& fit, int starts,
                                             const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
