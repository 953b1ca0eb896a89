// Energy distance between two samples: zero only where both have the same distribution, whatever that is.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Energy distance between two samples:
///
///   D = 2 mean |x_i - y_j| - mean |x_i - x_k| - mean |y_j - y_l|,   all pairs, those of i = k too
///
/// In one variable it is twice the integral of the squared difference of the distribution functions.
///
/// @param first, second  [sample x variable], no nan, at least 1 row each, the same columns
/// @return               >= 0 up to rounding, in the variables' unit
/// @throws InvalidInput  no row, or other columns
/// Source: [Szekely2013].
double energy_distance(const Eigen::Ref<const Eigen::MatrixXd>& first, const Eigen::Ref<const Eigen::MatrixXd>& second);

/// Mean of the unit vectors from the samples of `second` to each sample of `first`; equal samples give zero:
///
///   v_j = mean_i (x_j - y_i) / |x_j - y_i|,   dD/dx_j = 2 (v_j of second - v_j of first itself) / n
///
/// @return  [sample of `first` x variable]
Eigen::MatrixXd mean_unit_vectors(const Eigen::Ref<const Eigen::MatrixXd>& first,
                                  const Eigen::Ref<const Eigen::MatrixXd>& second);

}  // namespace mottle::stats
