#include "mottle/stats/distributions/standard_normal.hpp"

#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"

namespace mottle::stats {

namespace {
// Boost evaluates in long double by default, at several times the cost and for no digit that a double could keep.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
}  // namespace

double standard_normal_pdf(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

double standard_normal_cdf(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

double standard_normal_quantile(double probability) {
  require(0.0 <= probability && probability <= 1.0, "probability: {} is outside [0, 1]", probability);
  if (probability == 0.0) return -std::numeric_limits<double>::infinity();
  if (probability == 1.0) return std::numeric_limits<double>::infinity();
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * probability, Policy());
}

}  // namespace mottle::stats
