// Variables x whose transform t = g(x) is normal, given by mean and standard deviation of x itself.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"

namespace mottle::stats {

/// Mean and standard deviation of t.
struct TransformedMoments {
  double mean = 0.0;
  double std = 0.0;
};

/// Moments of t such that x has `mean` and `std`: the inverse of moments_of_variables.
///
/// Identity and log: closed forms. Logit: Newton's method on both moments.
/// @param std  >= 0
/// @return     nothing where no normal t gives them: a mean outside the support, or a standard deviation too large for
///             the bounds
std::optional<TransformedMoments> moments_of_transformed(const ParameterTransform& transform, double mean, double std);

/// Density of x whose t is normal with `moments`; 0 outside the support, and everywhere if t has no variance.
double density_of_variable(const ParameterTransform& transform, const TransformedMoments& moments, double x);

/// x at `count` even steps of t from `reach` standard deviations below the mean to as many above.
Eigen::VectorXd points_of_variable(const ParameterTransform& transform, const TransformedMoments& moments, double reach,
                                   Eigen::Index count);

}  // namespace mottle::stats
