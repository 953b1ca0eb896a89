// Boost's assertions check the starting values of its inversions, which recover from bad ones.
#define BOOST_DISABLE_ASSERTS  // hence no source is compiled together with this one
#include "stats/distributions/incomplete_functions.hpp"

#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <exception>

namespace mottle::stats {

namespace {

namespace policies = boost::math::policies;

/// In long double, as Boost's default is: powers of the order of a shape lose as many digits as it has, and their
/// factors underflow before the product does. Results beyond the doubles are 0 or infinity, which is what they are.
using InLongDouble =
    policies::policy<policies::domain_error<policies::ignore_error>, policies::pole_error<policies::ignore_error>,
                     policies::overflow_error<policies::ignore_error>,
                     policies::underflow_error<policies::ignore_error>, policies::denorm_error<policies::ignore_error>,
                     policies::rounding_error<policies::ignore_error>>;

/// OpenTURNS evaluates a beta's quantiles in double by the same library: those of samples keep the bits that they had
/// by it. They are right to 5e-13 with a shape of 1e-3, else to 1e-13.
using InDouble = policies::normalise<InLongDouble, policies::promote_double<false>>::type;

/// Bisection for log t, whose error is the relative one of t.
double searched_beta_quantile(double first, double second, double probability) {
  double low = std::log(0x1p-1074);
  double high = 0.0;
  // As many halvings as leave neighbouring doubles of a logarithm of this size.
  for (int halving = 0; halving < 64; ++halving) {
    const double middle = 0.5 * (low + high);
    const double t = std::exp(middle);
    (standard_beta_cdf(first, second, t, -std::expm1(middle)) < probability ? low : high) = middle;
  }
  return std::exp(high);
}

}  // namespace

double standard_beta_cdf(double first, double second, double below, double above) {
  return below <= above ? boost::math::ibeta(first, second, below, InLongDouble())
                        : boost::math::ibetac(second, first, above, InLongDouble());
}

double standard_beta_pdf(double first, double second, double below, double above) {
  return below <= above ? boost::math::ibeta_derivative(first, second, below, InLongDouble())
                        : boost::math::ibeta_derivative(second, first, above, InLongDouble());
}

double standard_beta_quantile(double first, double second, double probability) {
  // Eleven standard deviations of a normal; beyond, Boost's iteration may stop early, or not at all.
  constexpr double k_far = 1e-30;
  if (probability == 0.0) return 0.0;
  if (probability >= k_far) {
    try {
      return boost::math::ibeta_inv(first, second, probability, InDouble());
    } catch (
        const std::exception&) {  // NOLINT(bugprone-empty-catch): the search below needs no more than the arguments
    }
  }
  return searched_beta_quantile(first, second, probability);
}

double standard_gamma_cdf(double shape, double x) {
  return boost::math::gamma_p(shape, x, InLongDouble());
}

double standard_gamma_pdf(double shape, double x) {
  return boost::math::gamma_p_derivative(shape, x, InLongDouble());
}

double standard_gamma_quantile(double shape, double probability) {
  return boost::math::gamma_p_inv(shape, probability, InLongDouble());
}

double standard_gamma_upper_quantile(double shape, double probability) {
  return boost::math::gamma_q_inv(shape, probability, InLongDouble());
}

}  // namespace mottle::stats
