// The chi-squared distribution: limits and p-values of large-sample tests.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Value that a chi-squared variable stays below with the given probability.
///
/// @param probability         in [0, 1)
/// @param degrees_of_freedom  > 0
/// @throws InvalidInput       an argument outside its range
double chi_squared_quantile(double probability, double degrees_of_freedom);

/// P(chi-squared variable > value): the p-value of an observed statistic.
///
/// @param value               >= 0, may be infinite
/// @param degrees_of_freedom  > 0
/// @throws InvalidInput       an argument outside its range
double chi_squared_upper_tail(double value, double degrees_of_freedom);

}  // namespace mottle::stats
