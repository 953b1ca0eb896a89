#include "stats/distributions/truncated_moments.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace mottle::stats {

namespace {

using Rule = boost::math::quadrature::gauss<double, 30>;

/// Of bounds closer than two standard deviations: one rule is exact to rounding. Relative to the density at the middle,
/// whose exponent stays small however far out the bounds lie.
TruncatedMoments moments_of_narrow(double parent_mean, double std, double lower, double upper) {
  const double middle = 0.5 * lower + 0.5 * upper;
  const double half = 0.5 * (upper - lower);
  const auto moment = [&](double about, int power) {
    return Rule::integrate(
        [&](double t) {
          const double exponent = -half * t / std * ((0.5 * half * t + middle - parent_mean) / std);
          return std::pow(t - about, power) * std::exp(exponent);
        },
        -1.0, 1.0);
  };
  const double mass = moment(0.0, 0);
  const double mean = moment(0.0, 1) / mass;
  return {middle + half * mean, half * std::sqrt(moment(mean, 2) / mass)};
}

/// Of the standard normal in [from, to], in pieces of at most two, relative to its density at the most likely point.
TruncatedMoments moments_of_wide(double from, double to) {
  // exp(-50) is nothing beside 1, even if a bound lies far in a tail and all the mass at it.
  constexpr double k_nothing = 50.0;
  const double peak = std::clamp(0.0, from, to);
  const double reach = std::sqrt(peak * peak + 2.0 * k_nothing);
  const double begin = std::max(from, -reach);
  const double length = std::min(to, reach) - begin;
  const int pieces = static_cast<int>(std::ceil(0.5 * length));
  const auto moment = [&](double about, int power) {
    double sum = 0.0;
    for (int piece = 0; piece < pieces; ++piece) {
      sum += Rule::integrate(
          [&](double z) { return std::pow(z - about, power) * std::exp(-0.5 * (z - peak) * (z + peak)); },
          begin + length * piece / pieces, begin + length * (piece + 1) / pieces);
    }
    return sum;
  };
  const double mass = moment(peak, 0);
  const double mean = peak + moment(peak, 1) / mass;
  return {mean, std::sqrt(moment(mean, 2) / mass)};
}

}  // namespace

TruncatedMoments truncated_moments(double mean, double std, double lower, double upper) {
  if (upper - lower <= 2.0 * std) return moments_of_narrow(mean, std, lower, upper);
  const TruncatedMoments standard = moments_of_wide((lower - mean) / std, (upper - mean) / std);
  return {mean + std * standard.mean, std * standard.standard_deviation};
}

}  // namespace mottle::stats
