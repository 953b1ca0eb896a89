#include "mottle/stats/distributions/chi_squared.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle::stats {

double chi_squared_quantile(double probability, double degrees_of_freedom) {
  require(0.0 <= probability && probability < 1.0, "probability: {} is outside [0, 1)", probability);
  require(degrees_of_freedom > 0.0 && std::isfinite(degrees_of_freedom), "degrees of freedom: {} must be positive",
          degrees_of_freedom);
  return quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

double chi_squared_upper_tail(double value, double degrees_of_freedom) {
  require(value >= 0.0, "chi-squared value: {} must not be negative", value);
  require(degrees_of_freedom > 0.0 && std::isfinite(degrees_of_freedom), "degrees of freedom: {} must be positive",
          degrees_of_freedom);
  if (std::isinf(value)) return 0.0;
  return cdf(complement(boost::math::chi_squared(degrees_of_freedom), value));
}

}  // namespace mottle::stats
