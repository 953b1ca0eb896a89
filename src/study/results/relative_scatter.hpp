// Standard deviations as fractions of means, for tables.
#pragma once

#include <cmath>

#include "mottle/layers.hpp"

namespace mottle::study {

/// std / abs(mean); 0 where it is no more than what rounding leaves of equal values.
inline double relative_scatter(double standard_deviation, double mean) {
  constexpr double k_rounding = 1e-14;
  const double fraction = standard_deviation / std::abs(mean);
  return fraction <= k_rounding ? 0.0 : fraction;
}

}  // namespace mottle::study
