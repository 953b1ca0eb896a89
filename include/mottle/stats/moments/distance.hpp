// Distances between two mean vectors.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// sqrt((a - b)'(a - b)), in the vectors' unit.
///
/// @throws InvalidInput  sizes differ
double euclidean_distance(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b);

/// sqrt((a - b)' S^-1 (a - b)), dimensionless.
///
/// S is scaled to unit diagonal first, so that nothing depends on units. Where the result is singular (an eigenvalue
/// below 1e-12 of the largest), the pseudo-inverse on its range takes the place of the inverse: a difference along a
/// direction in which nothing varies does not count, and neither does a variable without variance.
///
/// @param a, b        [variable]
/// @param covariance  S [variable x variable], positive semi-definite
/// @throws InvalidInput  sizes differ, an entry not finite, or a negative variance
/// Source: [Mahalanobis1936].
double mahalanobis_distance(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b,
                            const Eigen::Ref<const Eigen::MatrixXd>& covariance);

}  // namespace mottle::stats
