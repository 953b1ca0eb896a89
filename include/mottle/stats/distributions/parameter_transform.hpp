// The transform under which a population of a variable is normal: identity, logarithm, or logit between two bounds.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// t = g(x), normal in the population.
///
///   identity: t = x;   log: t = ln x;   logit: t = ln((x - lower) / (upper - x))
struct ParameterTransform {
  enum class Kind { identity, log, logit };

  Kind kind = Kind::identity;
  double lower = 0.0;  ///< bounds of a logit
  double upper = 1.0;

  /// t of x; x must be possible: positive, or inside the bounds.
  double from_variable(double x) const;
  /// x of t.
  double to_variable(double t) const;
  /// dx/dt at t.
  double slope(double t) const;
};

/// "identity", "log" or "logit", as studies and results name the scale.
const char* scale_name(ParameterTransform::Kind kind);

/// x of t, and t of x, row by row [point x variable].
Eigen::MatrixXd to_variables(const std::vector<ParameterTransform>& transforms,
                             const Eigen::Ref<const Eigen::MatrixXd>& points);
Eigen::MatrixXd from_variables(const std::vector<ParameterTransform>& transforms,
                               const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// Mean and covariance of variables x whose t are normal with `mean` and `covariance`.
///
/// Closed forms for identity and log; Gauss-Hermite quadrature of 40 points a dimension where a logit takes part.
/// @param transforms  one a variable
/// @param mean        of t [variable]
/// @param covariance  of t [variable x variable], positive semi-definite
struct VariableMoments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};
VariableMoments moments_of_variables(const std::vector<ParameterTransform>& transforms,
                                     const Eigen::Ref<const Eigen::VectorXd>& mean,
                                     const Eigen::Ref<const Eigen::MatrixXd>& covariance);

}  // namespace mottle::stats
