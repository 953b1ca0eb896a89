#include "mottle/stats/distributions/transformed_moments.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

constexpr int k_max_steps = 60;
constexpr double k_tolerance = 1e-11;  // relative to the standard deviation
constexpr double k_reach = 6.0;        // in standard deviations: the probability beyond is 2e-9
constexpr int k_intervals = 60;

/// Mean and standard deviation of x by the trapezoidal rule over t, which for such integrands converges faster than any
/// power of the step. A Gauss rule is worse here: its outer nodes fall on the bound.
Eigen::Vector2d moments_on_axis(const ParameterTransform& transform, const TransformedMoments& moments) {
  const double step = 2.0 * k_reach / k_intervals;
  double mean = 0.0;
  for (int k = 0; k <= k_intervals; ++k) {
    const double z = -k_reach + k * step;
    mean += step * standard_normal_pdf(z) * transform.to_variable(moments.mean + moments.std * z);
  }
  double variance = 0.0;
  for (int k = 0; k <= k_intervals; ++k) {
    const double z = -k_reach + k * step;
    const double apart = transform.to_variable(moments.mean + moments.std * z) - mean;
    variance += step * standard_normal_pdf(z) * apart * apart;
  }
  return {mean, std::sqrt(variance)};
}

std::optional<TransformedMoments> moments_on_log(double mean, double std) {
  if (!(mean > 0.0)) return std::nullopt;
  const double variance = std::log1p((std / mean) * (std / mean));
  return TransformedMoments{std::log(mean) - 0.5 * variance, std::sqrt(variance)};
}

/// Newton's method with differences as derivatives; the standard deviation changes by a factor of two at most in
/// a step.
std::optional<TransformedMoments> moments_on_logit(const ParameterTransform& transform, double mean, double std) {
  if (!(mean > transform.lower && mean < transform.upper)) return std::nullopt;
  const double start = transform.from_variable(mean);
  TransformedMoments at{start, std / transform.slope(start)};
  if (std == 0.0) return at;
  for (int step = 0; step < k_max_steps; ++step) {
    const Eigen::Vector2d here = moments_on_axis(transform, at);
    const Eigen::Vector2d gap = Eigen::Vector2d(mean, std) - here;
    if (gap.norm() <= k_tolerance * std) return at;
    const double h = 1e-5 * at.std;
    Eigen::Matrix2d slope;
    slope << (moments_on_axis(transform, {at.mean + h, at.std}) - here) / h,
        (moments_on_axis(transform, {at.mean, at.std + h}) - here) / h;
    const Eigen::Vector2d change = slope.inverse() * gap;
    at = {at.mean + change(0), std::clamp(at.std + change(1), 0.5 * at.std, 2.0 * at.std)};
    if (!std::isfinite(at.mean) || !std::isfinite(at.std)) return std::nullopt;
  }
  // Rounding of the difference quotients may stop Newton's method a little above the tolerance; without a solution the
  // residual stays large.
  constexpr double k_near = 1e-6;
  const Eigen::Vector2d last = moments_on_axis(transform, at);
  return (Eigen::Vector2d(mean, std) - last).norm() <= k_near * std ? std::optional(at) : std::nullopt;
}

}  // namespace

std::optional<TransformedMoments> moments_of_transformed(const ParameterTransform& transform, double mean, double std) {
  if (!std::isfinite(mean) || !(std >= 0.0) || !std::isfinite(std)) return std::nullopt;
  switch (transform.kind) {
    case ParameterTransform::Kind::log:
      return moments_on_log(mean, std);
    case ParameterTransform::Kind::logit:
      return moments_on_logit(transform, mean, std);
    case ParameterTransform::Kind::identity:
      break;
  }
  return TransformedMoments{mean, std};
}

double density_of_variable(const ParameterTransform& transform, const TransformedMoments& moments, double x) {
  if (!(moments.std > 0.0)) return 0.0;
  if (transform.kind == ParameterTransform::Kind::log && !(x > 0.0)) return 0.0;
  if (transform.kind == ParameterTransform::Kind::logit && !(x > transform.lower && x < transform.upper)) return 0.0;
  const double t = transform.from_variable(x);
  const double slope = transform.slope(t);
  return slope > 0.0 ? standard_normal_pdf((t - moments.mean) / moments.std) / (moments.std * slope) : 0.0;
}

Eigen::VectorXd points_of_variable(const ParameterTransform& transform, const TransformedMoments& moments, double reach,
                                   Eigen::Index count) {
  Eigen::VectorXd points =
      Eigen::VectorXd::LinSpaced(count, moments.mean - reach * moments.std, moments.mean + reach * moments.std);
  for (double& point : points) point = transform.to_variable(point);
  return points;
}

}  // namespace mottle::stats
