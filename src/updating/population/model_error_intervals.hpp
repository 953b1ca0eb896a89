// Intervals of means where the model's error moves them further than the model is linear.
#pragma once

#include "mottle/layers.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Makes up for curved outputs in the intervals of means, whose halves are of first order in the model's error.
///
/// A half of h on the parameter's scale, h_0 of it without the model's error, takes a = sqrt(h^2 - h_0^2) / s_i
/// deviations of the error along its most harmful direction for parameter i, d = a C b_i / s_i with s_i^2 = b_i' C b_i,
/// C the error's covariance given the tests and b_i the mean's gain. The mean is estimated again with the tests off by
/// d and by -d, to lie u beyond the estimate; the half is multiplied by sqrt(h_0^2 + u^2) / h. It stays where no
/// parameters give such outputs.
///
/// @param evidence     of the fit, without bounds
/// @param centre       the means that the intervals are around, of the parameters themselves [parameter]
/// @param intervals    [parameter x 2]
/// @param evaluations  raised by the model runs that were needed
/// Source: limits of a sum from limits of its parts, [Zou2008].
void curve_by_model_error(const UpdatingProblem& problem, const PopulationFit& fit, const PopulationEvidence& evidence,
                          const Eigen::VectorXd& centre, const RunContext& context, std::int64_t& evaluations,
                          Eigen::MatrixXd& intervals);

}  // namespace mottle::updating
