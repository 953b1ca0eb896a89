// Wasserstein distances between samples of one variable, and their mean over directions for several.
#pragma once

#include <Eigen/Core>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"

namespace mottle::stats {

/// Wasserstein distance of two samples of one variable, with F^-1 and G^-1 the steps of their quantile functions:
///
///   W = (integral of |F^-1(u) - G^-1(u)|^order du, u from 0 to 1)^(1 / order)
///
/// @param first, second  at least 1 value each, no nan; their numbers may differ
/// @param order          1 or 2
/// @throws InvalidInput  no value, or another order
/// Source: [Peyre2019], section 2.6.
double wasserstein_distance(const Eigen::Ref<const Eigen::VectorXd>& first,
                            const Eigen::Ref<const Eigen::VectorXd>& second, int order);

/// Means of the quantile function of a sample over `cells` equal parts of (0, 1) [cell].
Eigen::VectorXd quantile_means(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index cells);

/// Unit vectors that are uniform on the sphere [direction x variable].
///
/// @param key  names the random streams, one a direction
Eigen::MatrixXd random_directions(Eigen::Index count, Eigen::Index dimension, const StreamKey& key);

/// Root mean square over directions of the Wasserstein distances of order 2 between projections.
///
/// @param first, second  [sample x variable]
/// @param directions     [direction x variable], at least one
/// Source: [Bonneel2015].
double sliced_wasserstein_distance(const Eigen::Ref<const Eigen::MatrixXd>& first,
                                   const Eigen::Ref<const Eigen::MatrixXd>& second,
                                   const Eigen::Ref<const Eigen::MatrixXd>& directions);

}  // namespace mottle::stats
