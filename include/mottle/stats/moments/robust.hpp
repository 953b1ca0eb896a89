// Location and scale that outliers do not move.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Median of the finite values, of an even number the mean of the two in the middle; nan: there are none.
double median(const Eigen::Ref<const Eigen::VectorXd>& values);

/// 1.4826 times the median distance from the median, of the finite values: the standard deviation where they are
/// normal, whatever fewer than half of them are; nan: there are none. Source: [Hampel1974].
double robust_deviation(const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace mottle::stats
