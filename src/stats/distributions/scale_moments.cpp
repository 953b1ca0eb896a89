#include "mottle/stats/distributions/scale_moments.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mottle::stats {
namespace {

constexpr int k_max_steps = 60;
constexpr double k_tolerance = 1e-11;  // of the deviation
constexpr double k_reach = 6.0;        // in deviations: what lies beyond is 2e-9
constexpr int k_intervals = 60;

double normal_density(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

/// Mean and deviation of x by the trapezoidal rule, which for such integrands converges faster than any power. It knows
/// no narrow populations at a bound, unlike a Gauss rule, whose far nodes lie there.
Eigen::Vector2d moments_on_axis(const NormalScale& scale, const ScaleMoments& moments) {
  const double step = 2.0 * k_reach / k_intervals;
  double mean = 0.0;
  for (int k = 0; k <= k_intervals; ++k) {
    const double z = -k_reach + k * step;
    mean += step * normal_density(z) * scale.to_variable(moments.mean + moments.std * z);
  }
  double variance = 0.0;
  for (int k = 0; k <= k_intervals; ++k) {
    const double z = -k_reach + k * step;
    const double apart = scale.to_variable(moments.mean + moments.std * z) - mean;
    variance += step * normal_density(z) * apart * apart;
  }
  return {mean, std::sqrt(variance)};
}

std::optional<ScaleMoments> moments_on_log(double mean, double std) {
  if (!(mean > 0.0)) return std::nullopt;
  const double variance = std::log1p((std / mean) * (std / mean));
  return ScaleMoments{std::log(mean) - 0.5 * variance, std::sqrt(variance)};
}

/// Newton's method with differences as derivatives; the deviation changes by a factor of two at most in a step.
std::optional<ScaleMoments> moments_on_logit(const NormalScale& scale, double mean, double std) {
  if (!(mean > scale.lower && mean < scale.upper)) return std::nullopt;
  const double start = scale.from_variable(mean);
  ScaleMoments at{start, std / scale.slope(start)};
  if (std == 0.0) return at;
  for (int step = 0; step < k_max_steps; ++step) {
    const Eigen::Vector2d here = moments_on_axis(scale, at);
    const Eigen::Vector2d gap = Eigen::Vector2d(mean, std) - here;
    if (gap.norm() <= k_tolerance * std) return at;
    const double h = 1e-5 * at.std;
    Eigen::Matrix2d slope;
    slope << (moments_on_axis(scale, {at.mean + h, at.std}) - here) / h,
        (moments_on_axis(scale, {at.mean, at.std + h}) - here) / h;
    const Eigen::Vector2d change = slope.inverse() * gap;
    at = {at.mean + change(0), std::clamp(at.std + change(1), 0.5 * at.std, 2.0 * at.std)};
    if (!std::isfinite(at.mean) || !std::isfinite(at.std)) return std::nullopt;
  }
  // Differences end the progress a little above the tolerance; where there is no solution the gap stays wide.
  constexpr double k_near = 1e-6;
  const Eigen::Vector2d last = moments_on_axis(scale, at);
  return (Eigen::Vector2d(mean, std) - last).norm() <= k_near * std ? std::optional(at) : std::nullopt;
}

}  // namespace

std::optional<ScaleMoments> moments_on_scale(const NormalScale& scale, double mean, double std) {
  if (!std::isfinite(mean) || !(std >= 0.0) || !std::isfinite(std)) return std::nullopt;
  switch (scale.kind) {
    case NormalScale::Kind::log:
      return moments_on_log(mean, std);
    case NormalScale::Kind::logit:
      return moments_on_logit(scale, mean, std);
    case NormalScale::Kind::identity:
      break;
  }
  return ScaleMoments{mean, std};
}

double density_on_scale(const NormalScale& scale, const ScaleMoments& moments, double x) {
  if (!(moments.std > 0.0)) return 0.0;
  if (scale.kind == NormalScale::Kind::log && !(x > 0.0)) return 0.0;
  if (scale.kind == NormalScale::Kind::logit && !(x > scale.lower && x < scale.upper)) return 0.0;
  const double t = scale.from_variable(x);
  const double slope = scale.slope(t);
  return slope > 0.0 ? normal_density((t - moments.mean) / moments.std) / (moments.std * slope) : 0.0;
}

Eigen::VectorXd points_on_scale(const NormalScale& scale, const ScaleMoments& moments, double reach,
                                Eigen::Index count) {
  Eigen::VectorXd points =
      Eigen::VectorXd::LinSpaced(count, moments.mean - reach * moments.std, moments.mean + reach * moments.std);
  for (double& point : points) point = scale.to_variable(point);
  return points;
}

}  // namespace mottle::stats
