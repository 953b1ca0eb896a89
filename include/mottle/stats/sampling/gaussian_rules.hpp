// Points and weights for means over independent standard normal variables.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// E[f(w)] = sum_i weight_i f(point_i), w ~ N(0, I).
struct GaussianRule {
  Eigen::MatrixXd points;   ///< [point x variable]
  Eigen::VectorXd weights;  ///< sum 1; not all positive in a rule of degree 5 for more than 4 variables
};

/// Gauss-Hermite rule of one variable: exact for polynomials up to degree 2 `points` - 1.
///
/// @param points  >= 1
/// Source: [GolubWelsch1969].
GaussianRule hermite_rule(int points);

/// The product of one-dimensional Gauss-Hermite rules: points^dimension points.
///
/// @param dimension  >= 1
/// @throws InvalidInput  more than 1e6 points
GaussianRule tensor_hermite_rule(Eigen::Index dimension, int points);

/// Fully symmetric rule of degree 5 with 2 dimension^2 + 1 points: the origin, +-sqrt 3 on every axis, and
/// (+-sqrt 3, +-sqrt 3) on every pair of axes.
///
/// @param dimension  >= 1
/// Source: [McNamee1967].
GaussianRule fifth_degree_rule(Eigen::Index dimension);

/// Equal weights on a design that is shifted and sheared so that its mean is exactly 0 and its covariance exactly I:
/// moments of linear functions are then exact, those of others have the design's error.
///
/// @param uniforms  [point x variable], in (0, 1); more points than variables
/// @throws InvalidInput  too few points, or points in a plane
GaussianRule standardised_rule(const Eigen::Ref<const Eigen::MatrixXd>& uniforms);

}  // namespace mottle::stats
