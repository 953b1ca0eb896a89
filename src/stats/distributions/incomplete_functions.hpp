// The incomplete beta and gamma functions as probabilities: distribution function, density and quantile of the
// standard beta and gamma. Boost.Math evaluates them; where its inversion gives up, a search takes over.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Beta distribution on [0, 1] with shapes `first`, `second` in (0, 1e8].
///
///   F(t) = B(t; first, second) / B(first, second)
///
/// @param below, above  t and 1 - t, each with its own digits: one of them may be tiny
double standard_beta_cdf(double first, double second, double below, double above);
double standard_beta_pdf(double first, double second, double below, double above);

/// t with F(t) = probability, in [0, 1/2]; relative accuracy holds in the lower tail. The upper tail is the lower one
/// of the exchanged shapes.
double standard_beta_quantile(double first, double second, double probability);

/// Gamma distribution of rate 1 with a shape in [1e-6, 1e8].
///
///   F(x) = gamma(shape, x) / Gamma(shape),   x >= 0
double standard_gamma_cdf(double shape, double x);
double standard_gamma_pdf(double shape, double x);

/// x with F(x) = probability, in [0, 1/2].
double standard_gamma_quantile(double shape, double probability);
/// x with 1 - F(x) = probability, in [0, 1/2].
double standard_gamma_upper_quantile(double shape, double probability);

}  // namespace mottle::stats
