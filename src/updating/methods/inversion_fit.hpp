// Fits the parameters to each specimen alone, all specimens in one batch of model runs.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {

/// Where the fits of all specimens stand.
struct InversionFit {
  enum class Ending {
    moving,   ///< not at rest when the iterations were used up
    at_rest,  ///< no parameter moves by more than the tolerance
    stuck,    ///< no step makes the residuals smaller
  };

  Eigen::MatrixXd points;                  ///< t [specimen x parameter]
  Eigen::MatrixXd outputs;                 ///< f there [specimen x output]
  std::vector<Eigen::MatrixXd> jacobians;  ///< dy/dt, at the last point but one where a fit is at rest
  std::vector<Ending> endings;
  std::vector<int> ranks;  ///< combinations of parameters that each specimen's outputs see
  std::int64_t evaluations = 0;

  Eigen::Index count(Ending ending) const;
};

/// Gauss-Newton with Levenberg's damping where a step fails, for every row of `targets` by itself:
///
///   min over t within the bounds of sum_k ((z_k - f_k(t)) / sigma_k)^2
///
/// over the entries that are measured; where these do not decide, t is the nearest to the prior mean in prior
/// deviations.
///
/// @param targets    [specimen x output], nan where not measured
/// @param sigma      weights of the residuals, > 0 [output]
/// @param start      t to begin with [specimen x parameter]
/// @param after_each called with the present state after each iteration; returns whether to go on
/// Throws SystemFailure: the model fails at the start of a specimen.
InversionFit invert_specimens(const UpdatingProblem& problem, const ScaledParameters& parameters,
                              const Eigen::Ref<const Eigen::MatrixXd>& targets,
                              const Eigen::Ref<const Eigen::VectorXd>& sigma,
                              const Eigen::Ref<const Eigen::MatrixXd>& start, const RunContext& context,
                              const std::function<bool(const InversionFit&)>& after_each);

}  // namespace mottle::updating
