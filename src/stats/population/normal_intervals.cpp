#include "mottle/stats/population/normal_intervals.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

void require_sample(double std, int count, double confidence) {
  require(count >= 2, "an interval needs a sample of at least 2, found {}", count);
  require(std >= 0.0 && std::isfinite(std), "a standard deviation of {} is not possible", std);
  require(0.0 < confidence && confidence < 1.0, "confidence: {} is outside (0, 1)", confidence);
}

/// P((r B22 - Z) / B11 <= c), r and c tangents of the angles whose sines are the correlations.
double fiducial_probability(double c, double r, int count) {
  const double first = count - 1;
  const double second = count - 2;
  const boost::math::students_t student(first + second);
  const double root = std::sqrt(first + second);
  // B11 = R cos a, B22 = R sin a: the angle has this density, and R^2 ~ chi-squared(first + second) is independent.
  const double log_scale = std::log(2.0 / boost::math::beta(0.5 * first, 0.5 * second));
  const auto integrand = [&](double angle) {
    const double cosine = std::cos(angle);
    const double sine = std::sin(angle);
    const double log_density =
        log_scale + (first - 1.0) * std::log(cosine) + (second > 1.0 ? (second - 1.0) * std::log(sine) : 0.0);
    return std::exp(log_density) * boost::math::cdf(student, root * (c * cosine - r * sine));
  };
  constexpr double k_right_angle = 1.57079632679489661923;
  // The density is a peak of width 1 / sqrt(count) at the angle of its mode: the interval is cut there.
  const double mode = std::atan2(std::sqrt(second), std::sqrt(first));
  const double width = std::min(12.0 / std::sqrt(first + second), k_right_angle);
  const double lower = std::max(mode - width, 0.0);
  const double upper = std::min(mode + width, k_right_angle);
  using Rule = boost::math::quadrature::gauss_kronrod<double, 61>;
  return Rule::integrate(integrand, lower, mode, 0) + Rule::integrate(integrand, mode, upper, 0);
}

/// rho = sin(angle) whose fiducial probability is the given one.
double fiducial_quantile(double probability, double r, int count) {
  constexpr double k_almost_right_angle = 1.57079632;  // a correlation of 1 - 2e-17
  std::uintmax_t evaluations = 100;
  const auto excess = [&](double angle) { return fiducial_probability(std::tan(angle), r, count) - probability; };
  if (excess(-k_almost_right_angle) >= 0.0) return -1.0;
  if (excess(k_almost_right_angle) <= 0.0) return 1.0;
  const auto [lower, upper] = boost::math::tools::toms748_solve(
      excess, -k_almost_right_angle, k_almost_right_angle, boost::math::tools::eps_tolerance<double>(46), evaluations);
  return std::sin(0.5 * (lower + upper));
}

}  // namespace

Interval mean_interval(double mean, double std, int count, double confidence) {
  require_sample(std, count, confidence);
  const boost::math::students_t student(count - 1);
  const double half = boost::math::quantile(student, 0.5 + 0.5 * confidence) * std / std::sqrt(count);
  return {mean - half, mean + half};
}

Interval standard_deviation_interval(double std, int count, double confidence) {
  require_sample(std, count, confidence);
  const boost::math::chi_squared distribution(count - 1);
  const double tail = 0.5 - 0.5 * confidence;
  const double degrees_of_freedom = count - 1;
  return {std * std::sqrt(degrees_of_freedom / boost::math::quantile(complement(distribution, tail))),
          std * std::sqrt(degrees_of_freedom / boost::math::quantile(distribution, tail))};
}

Interval correlation_interval(double correlation, int count, double confidence) {
  require_sample(0.0, count, confidence);
  require(-1.0 <= correlation && correlation <= 1.0, "a correlation of {} is not possible", correlation);
  if (count == 2) return {-1.0, 1.0};
  if (std::abs(correlation) == 1.0) return {correlation, correlation};
  const double r = correlation / std::sqrt((1.0 - correlation) * (1.0 + correlation));
  const double tail = 0.5 - 0.5 * confidence;
  return {fiducial_quantile(tail, r, count), fiducial_quantile(1.0 - tail, r, count)};
}

}  // namespace mottle::stats
