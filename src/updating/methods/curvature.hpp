// What curvature of the outputs does to an estimate that is linear around each specimen.
#pragma once

#include "mottle/layers.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Bias of the mean by the outputs' curvature, to second order, in standard errors of the mean [parameter].
///
/// A specimen's parameters given its test are not symmetric where outputs are curved: their mean is beside the most
/// probable value, at which the first-order likelihood is linearised. With P the covariance of a specimen's parameters
/// given its test, K = Sigma G' C^-1 and H_k the second derivatives of output k, the estimated mean is off by
///
///   A^-1 sum_s [ G' C^-1 b + M sum_k H_k K_k ],   b_k = tr(P H_k) / 2,   M = I - G' C^-1 G Sigma,   A = sum_s G' C^-1
///   G
///
/// Nothing without noise or without curvature. H_k by differences at the estimated mean over the mean posterior
/// deviations: 2 q^2 + 1 model runs in one batch. nan where the model fails there.
///
/// @return  0 where the outputs do not see a parameter
/// Source: [Lindstrom1990] for the linearisation; the third derivatives of the log-posterior as in [Tierney1986].
Eigen::VectorXd curvature_bias(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                               std::int64_t& evaluations);

/// Puts the bias into the result, and a note where it is more than half a standard error.
void describe_curvature(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                        UpdatingResult& result);

}  // namespace mottle::updating
