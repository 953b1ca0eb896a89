// Whether other parameters explain the mean of the tests as well.
#pragma once

#include "population_fit.hpp"

namespace mottle {

/// Means of the parameters that give the mean test as well as the estimate does, found from starts drawn from the prior
/// (Latin hypercube); each within the bounds and apart from the others by more than a tenth of a prior deviation in
/// some direction that the outputs see.
///
/// @param starts  number of starts
/// @return        on the parameters' own axes [parameter], nearest to the prior first
std::vector<Eigen::VectorXd> other_solutions(const UpdatingProblem& problem, const PopulationFit& fit, int starts,
                                             const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle
