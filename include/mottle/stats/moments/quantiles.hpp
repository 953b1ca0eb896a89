// Quantiles of samples, linear between order statistics.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// The probability at which the i-th smallest of n values, i = 1 to n, is the quantile.
/// Source: [Hyndman1996], types 5, 6 and 7.
enum class QuantileRule {
  midpoints,    ///< (i - 1/2) / n
  expectation,  ///< i / (n + 1): what the distribution function has there on average
  ends,         ///< (i - 1) / (n - 1): the smallest value at 0, the largest at 1
};

/// Linear between the order statistics, the extremes beyond them. A place next to an infinite value has that value.
///
/// @param sorted       ascending, not empty
/// @param probability  in [0, 1]
double sorted_quantile(std::span<const double> sorted, double probability, QuantileRule rule);

/// The quantile of values in any order, not empty.
double quantile(std::vector<double> values, double probability, QuantileRule rule);

/// The quantiles (1 - confidence) / 2 and (1 + confidence) / 2. A nan counts as infinite: a number that was too large.
///
/// @param values      not empty, in any order
/// @param confidence  in (0, 1)
Eigen::RowVector2d equal_tails(std::vector<double> values, double confidence, QuantileRule rule);

}  // namespace mottle::stats
