// Mean and standard deviation of a normal variable between bounds.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

struct TruncatedMoments {
  double mean;
  double standard_deviation;
};

/// Moments of N(mean, std^2) given lower <= X <= upper, to 1e-14 relative to the result's own standard deviation (and,
/// as to the mean, its rounding).
///
///   E[X^k | lower <= X <= upper] = int x^k exp(-(x - mean)^2 / (2 std^2)) dx / int exp(-(x - mean)^2 / (2 std^2)) dx
///
/// by Gauss rules: the closed form subtracts nearly equal numbers where the bounds are close together, or lie far in a
/// tail, compared with std.
TruncatedMoments truncated_moments(double mean, double std, double lower, double upper);

}  // namespace mottle::stats
