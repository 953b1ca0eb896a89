// The standard normal distribution: probability and quantile with full relative accuracy in both tails.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Density exp(-z^2 / 2) / sqrt(2 pi) of a standard normal.
double standard_normal_pdf(double z);

/// P(N <= z) of a standard normal N: erfc(-z / sqrt 2) / 2.
double standard_normal_cdf(double z);

/// z with P(N <= z) = probability: -sqrt 2 erfc^-1(2 probability).
///
/// @param probability  in (0, 1); relative accuracy holds down to the smallest double
/// @return             z; -infinity at 0, +infinity at 1. Near 1 pass 1 - p and change the sign where p itself is
///                     not given exactly.
/// @throws InvalidInput  probability outside [0, 1] or nan
double standard_normal_quantile(double probability);

}  // namespace mottle::stats
