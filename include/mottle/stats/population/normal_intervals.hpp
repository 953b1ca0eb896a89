// Confidence intervals of a normal population's mean, standard deviation and correlation from a complete sample.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

/// The two ends of an interval.
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};

/// Interval of a mean: mean +- t std / sqrt(count), t of Student's distribution with count - 1 degrees of freedom.
///
/// @param std         sample standard deviation, >= 0
/// @param count       sample size, >= 2
/// @param confidence  in (0, 1), 0.95
/// @throws InvalidInput  an argument outside its range
Interval mean_interval(double mean, double std, int count, double confidence);

/// Interval of a standard deviation: std sqrt((count - 1) / chi2), chi2 the quantiles of chi-squared with count - 1
/// degrees of freedom. Arguments and errors as mean_interval.
Interval standard_deviation_interval(double std, int count, double confidence);

/// Exact interval of the correlation of two normal variables.
///
/// With r* = r / sqrt(1 - r^2) and the Bartlett factors of a Wishart matrix, B11 ~ chi(count - 1),
/// B22 ~ chi(count - 2), Z ~ N(0, 1), the correlation of the population is distributed as rho* / sqrt(1 + rho*^2),
/// rho* = (r* B22 - Z) / B11. The probability P(rho* <= c) is the mean over the angle of (B11, B22) of a Student
/// probability with 2 count - 3 degrees of freedom, a smooth integral; its quantiles are found by bracketing.
///
/// @param correlation  of the sample, in [-1, 1]
/// @param count        sample size, >= 2; of two nothing is known: [-1, 1]
/// @throws InvalidInput  an argument outside its range
/// Source: [Anderson2003], section 4.2 and 7.2.
Interval correlation_interval(double correlation, int count, double confidence);

}  // namespace mottle::stats
