// Variables that are normal on a scale, given by mean and standard deviation of the variable itself.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/normal_scale.hpp"

namespace mottle::stats {

/// Mean and standard deviation of t.
struct ScaleMoments {
  double mean = 0.0;
  double std = 0.0;
};

/// Moments of t such that x has `mean` and `std`: the inverse of moments_of_variables.
///
/// Identity and log: closed forms. Logit: Newton's method on both moments.
/// @param std  >= 0
/// @return     nothing where no normal t gives them: a mean outside the scale, or a deviation too wide for the bounds
std::optional<ScaleMoments> moments_on_scale(const NormalScale& scale, double mean, double std);

/// Density of x, normal with `moments` on the scale; 0 outside the scale and where it has no width.
double density_on_scale(const NormalScale& scale, const ScaleMoments& moments, double x);

/// x at `count` even steps of t from `reach` deviations below the mean to as many above.
Eigen::VectorXd points_on_scale(const NormalScale& scale, const ScaleMoments& moments, double reach,
                                Eigen::Index count);

}  // namespace mottle::stats
