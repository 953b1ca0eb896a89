#include "mottle/stats/distributions/student_t.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

/// Quantiles to 15 digits are worth no long double, and a tail beyond all numbers is infinite.
using Policy =
    boost::math::policies::policy<boost::math::policies::promote_double<false>,
                                  boost::math::policies::overflow_error<boost::math::policies::ignore_error>>;

/// The t that a variable exceeds with the given probability.
double upper_quantile(double probability, double degrees_of_freedom) {
  const boost::math::students_t_distribution<double, Policy> t(degrees_of_freedom);
  return quantile(complement(t, probability));
}

}  // namespace

double student_t_of_score(double score, double degrees_of_freedom) {
  return std::copysign(upper_quantile(standard_normal_cdf(-std::abs(score)), degrees_of_freedom), score);
}

/// Near zero, with v = P / (2 c) of t's density c at 0, x = v + (1 + 1/nu) v^3 / 6 + (7 + 8/nu + 1/nu^2) v^5 / 120 +
/// ..., the inverse of the density's integrated series: the quantile of 1/2 - P/2 has lost the digits of P.
double half_t_of_score(double score, double degrees_of_freedom) {
  constexpr double k_series = -3.0;  // below it P < 1.4e-3, and the next term is less than 1e-16 of x for nu >= 0.5
  if (score > k_series) return upper_quantile(0.5 * standard_normal_cdf(-score), degrees_of_freedom);
  const double nu = degrees_of_freedom;
  const double gammas = boost::math::tgamma_delta_ratio(0.5 * nu, 0.5, Policy());  // Gamma(nu/2) / Gamma(nu/2 + 1/2)
  const double v = 0.5 * standard_normal_cdf(score) * gammas * std::sqrt(nu * std::numbers::pi);
  const double third = (1.0 + 1.0 / nu) / 6.0;
  const double fifth = (7.0 + (8.0 + 1.0 / nu) / nu) / 120.0;
  return v * (1.0 + v * v * (third + v * v * fifth));
}

}  // namespace mottle::stats
