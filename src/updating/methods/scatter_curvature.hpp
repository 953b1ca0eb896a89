// What curved outputs add to the means of specimens that scatter.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Means of the outputs of specimens that scatter as the tests do, to second order:
///
///   y(c) + 1/2 sum_ij (d2 y / dt_i dt_j) S_ij,   S = (n - 1) / n T (V - R) T',   c = t + T (z - y(t)),
///
/// z the tests' mean, V their covariance, R their noise, T the least change of the parameters that explains an output.
/// The step to c counts: a mean that was weighed by the tests' own covariance is off by parts of their scatter. Taken
/// along the principal axes of S, from the model a standard deviation to either side of c: two runs for each parameter.
///
/// @param point        t, on the parameters' scales [parameter]
/// @param sensitivity  dy/dt there [output x parameter]
/// @param evaluations  raised by the model runs that were needed
/// @return             [output]; nan where the model fails there
Eigen::VectorXd means_of_scattered(const UpdatingProblem& problem, const Eigen::VectorXd& point,
                                   const Eigen::MatrixXd& sensitivity, const RunContext& context,
                                   std::int64_t& evaluations);

}  // namespace mottle::updating
