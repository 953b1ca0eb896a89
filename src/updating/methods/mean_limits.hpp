// Whether the estimated means lie where the tests put them: against the bounds, and against the prior.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {

/// The mean that the tests alone ask for, on the parameters' scales: no bound holds it.
struct FreeMean {
  Eigen::VectorXd mean;        ///< [parameter]
  Eigen::MatrixXd covariance;  ///< of `mean` [parameter x parameter]
  double degrees_of_freedom;   ///< that `covariance` rests on; infinite: known
};

/// Test "bounds": the distance of the free mean m from the nearest point u within bounds and physical limits,
///
///   min over u of (u - m)' C^-1 (u - m),
///
/// against its law where the true mean lies on all the bounds that are near (within 3 standard errors): one-sided
/// Student t for one, the chi-bar-squared law, drawn with the estimated covariance, for more. Made where a bound is
/// near; listed where the free mean lies beyond one.
/// Source: [Silvapulle2005], ch. 3.
void plan_bound_test(const UpdatingProblem& problem, const FreeMean& free, TestPlan& plan);

/// Test "prior-shift": the largest shift of a mean from the prior's, on the parameters' scales,
///
///   |m - t0| / sqrt(s0^2 + c^2),
///
/// s0 the prior's standard deviation and c the mean's own, fails beyond 10. A prior of one peak, of whatever form, puts
/// less than 0.5 % there, a normal one 1e-23: the test takes nothing of the level. Listed where it fails.
/// Source: [Vysochanskij1980].
void plan_prior_shift(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::VectorXd>& mean,
                      const Eigen::Ref<const Eigen::MatrixXd>& covariance, TestPlan& plan);

/// The nearest point to `mean` in the metric of `covariance` with u >= 0.
Eigen::VectorXd nearest_non_negative(const Eigen::Ref<const Eigen::VectorXd>& mean,
                                     const Eigen::Ref<const Eigen::MatrixXd>& covariance);

}  // namespace mottle::updating
