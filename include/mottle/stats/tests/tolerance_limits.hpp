// Tolerance limits: bounds that contain a stated fraction of a population with a stated confidence.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Factor k of the two-sided normal tolerance limits mean +- k s, which contain at least the fraction `content` of the
/// population with probability `confidence`:
///
///   2 sqrt(n) int_0^inf P(chi2_(n - 1) > (n - 1) r(z)^2 / k^2) phi(sqrt(n) z) dz = confidence,
///   Phi(z + r) - Phi(z - r) = content
///
/// Exact for normal samples, by quadrature (relative error below 1e-6).
///
/// @param specimens             n >= 2
/// @param content, confidence   in [0.5, 0.999]
/// @throws InvalidInput  an argument outside its range
/// Source: [KrishnamoorthyMathew2009], Eq. 2.3.4.
double normal_tolerance_factor(int specimens, double content, double confidence);

/// Confidence with which the smallest and the largest of n values of any continuous population contain the fraction
/// `content` of it: 1 - n c^(n-1) + (n-1) c^n.
///
/// @param specimens  n >= 2
/// Source: [Wilks1941].
double confidence_of_extremes(int specimens, double content);

/// The fraction that the extremes of n values contain with that confidence.
double content_of_extremes(int specimens, double confidence);

/// The least number of values whose extremes contain the fraction `content` with that confidence: 93 for 0.95 and 0.95.
///
/// @throws InvalidInput  an argument outside [0.5, 0.999]
int specimens_for_extremes(double content, double confidence);

}  // namespace mottle::stats
