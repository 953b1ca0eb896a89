// Whether other parameters explain the mean of the tests as well.
#pragma once

#include "mottle/layers.hpp"
#include "updating/population/solved_population.hpp"

namespace mottle::updating {

/// Puts into the result the solutions that explain the mean test z as well as the estimate does. With M = (G Sigma G' +
/// R) / n, the sampling covariance of z, a solution t explains z as well where
///
///   (z - f(t))' M^-1 (z - f(t)) <= the same of the estimate + chi2_q(1 - level),
///
/// q the number of combinations that the outputs see. It is another solution where its population's mean lies apart
/// from the others': beyond their joint confidence ellipsoid of that level, to first order, and by more than a tenth of
/// a prior deviation in some direction that the outputs see. Each has the weight that solve_population() gives it,
/// relative to the sum of all that are named, the estimate included.
///
/// @param estimate  the population that `result` holds: the first of `solutions`, or what was made of it
/// @param starts    of the search for them
/// @param result    `other_solutions`, greatest weight first, and `search` are set
void name_other_solutions(const UpdatingProblem& problem, const PopulationFit& estimate,
                          const std::vector<PopulationSolution>& solutions, int starts, UpdatingResult& result);

struct BestStart {
  PriorOnScales start;
  Eigen::VectorXd solution;  ///< of the tests' mean, the one of the greatest weight; empty: there was no search
};

/// Where a method without a likelihood of its own starts, on the scales: with the prior if its mean leads to the
/// solution of the greatest weight, else with the population there, a hundredth of the prior's variance added. Where
/// the tests' mean has several solutions, the population is fitted from each by the settings of `maximum-likelihood`.
/// Sets `other_solutions` and `search` as above.
///
/// @param result  its first state holds the prior's cloud
BestStart start_at_best(const UpdatingProblem& problem, const RunContext& context, std::int64_t& evaluations,
                        UpdatingResult& result);

}  // namespace mottle::updating
