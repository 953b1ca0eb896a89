#include "study/results/density_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "mottle/stats/distributions/transformed_moments.hpp"

namespace mottle::study {
namespace {

constexpr Eigen::Index k_points = 161;
constexpr Eigen::Index k_family_points = 241;  // of families that may rise steeply
constexpr double k_reach = 4.0;                // in standard deviations

double normal_density(double x, double std) {
  return std::exp(-0.5 * (x / std) * (x / std)) / (std * std::sqrt(2.0 * std::numbers::pi));
}

DensityCurve box(const DistributionSpec& spec) {
  const double height = 1.0 / (spec.upper - spec.lower);
  return {Eigen::Vector4d(spec.lower, spec.lower, spec.upper, spec.upper), Eigen::Vector4d(0.0, height, height, 0.0)};
}

/// Where a family that is not a transformed normal is drawn. Densities may be infinite at the ends of a support.
std::pair<double, double> drawn_range(const Distribution& prior) {
  constexpr double k_inset = 1e-3;  // of the support, or of the mean
  const DistributionSpec& spec = prior.spec();
  const double mean = spec.mean;
  const double std = spec.std;
  if (spec.kind == DistributionKind::truncated_normal) {
    return {std::max(spec.lower, mean - 5.0 * std), std::min(spec.upper, mean + 5.0 * std)};
  }
  if (spec.kind == DistributionKind::beta) {
    const double inset = k_inset * (spec.upper - spec.lower);
    return {std::max(spec.lower + inset, mean - 6.0 * std), std::min(spec.upper - inset, mean + 6.0 * std)};
  }
  return {std::max(k_inset * mean, mean - 4.0 * std), mean + 6.0 * std};  // gamma
}

DensityCurve curve_of_variable(const ParameterTransform& transform, const TransformedMoments& moments) {
  DensityCurve curve{points_of_variable(transform, moments, k_reach, k_points), {}};
  curve.density = curve.x.unaryExpr([&](double x) { return density_of_variable(transform, moments, x); });
  return curve;
}

/// Envelope of normal densities with a mean in [a, b] and a standard deviation in [c, d].
DensityBand normal_band(const Eigen::Vector2d& mean, const Eigen::Vector2d& std, double reach) {
  DensityBand band;
  band.x = Eigen::VectorXd::LinSpaced(k_points, mean(0) - reach * std(1), mean(1) + reach * std(1));
  band.lower.resize(k_points);
  band.upper.resize(k_points);
  for (Eigen::Index k = 0; k < k_points; ++k) {
    const double x = band.x(k);
    const double near = std::max({0.0, mean(0) - x, x - mean(1)});
    const double far = std::max(std::abs(x - mean(0)), std::abs(x - mean(1)));
    band.lower(k) = std::min(normal_density(far, std(0)), normal_density(far, std(1)));
    band.upper(k) = normal_density(near, std::min(std(1), std::max(std(0), near)));
  }
  return band;
}

/// The pairs of mean and standard deviation within their intervals that some transformed normal has.
std::vector<TransformedMoments> moments_within(const ParameterTransform& transform, const Eigen::Vector2d& mean,
                                               const Eigen::Vector2d& std) {
  std::vector<TransformedMoments> found;
  for (const double m : Eigen::VectorXd::LinSpaced(17, mean(0), mean(1))) {
    for (const double s : Eigen::VectorXd::LinSpaced(7, std(0), std(1))) {
      if (const auto moments = moments_of_transformed(transform, m, s)) found.push_back(*moments);
    }
  }
  return found;
}

DensityBand band_of_variable(const ParameterTransform& transform, const std::vector<TransformedMoments>& pairs,
                             double reach) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const TransformedMoments& moments : pairs) {
    low = std::min(low, transform.to_variable(moments.mean - reach * moments.std));
    high = std::max(high, transform.to_variable(moments.mean + reach * moments.std));
  }
  DensityBand band{Eigen::VectorXd::LinSpaced(k_points, low, high), Eigen::VectorXd(k_points),
                   Eigen::VectorXd(k_points)};
  for (Eigen::Index k = 0; k < k_points; ++k) {
    double lower = std::numeric_limits<double>::infinity();
    double upper = 0.0;
    for (const TransformedMoments& moments : pairs) {
      const double density = density_of_variable(transform, moments, band.x(k));
      lower = std::min(lower, density);
      upper = std::max(upper, density);
    }
    band.lower(k) = lower;
    band.upper(k) = upper;
  }
  return band;
}

}  // namespace

DensityCurve normal_curve(double mean, double std) {
  if (!std::isfinite(mean) || !(std > 0.0) || !std::isfinite(std)) return {};
  return curve_of_variable({}, {mean, std});
}

DensityCurve prior_curve(const Distribution& prior) {
  const DistributionSpec& spec = prior.spec();
  if (spec.kind == DistributionKind::uniform) return box(spec);
  if (spec.kind == DistributionKind::normal) return normal_curve(spec.mean, spec.std);
  if (spec.kind == DistributionKind::lognormal) {
    const ParameterTransform transform{ParameterTransform::Kind::log};
    const auto moments = moments_of_transformed(transform, spec.mean, spec.std);
    return moments ? curve_of_variable(transform, *moments) : DensityCurve{};
  }
  const auto [low, high] = drawn_range(prior);
  DensityCurve curve{Eigen::VectorXd::LinSpaced(k_family_points, low, high), {}};
  curve.density = curve.x.unaryExpr([&](double x) { return prior.pdf(x); });
  if (!curve.density.allFinite()) return {};
  return curve;
}

DensityBand density_band(const ParameterTransform& transform, const Eigen::Vector2d& mean, const Eigen::Vector2d& std) {
  constexpr double k_min_fraction = 0.02;
  constexpr double k_band_reach = 3.5;
  if (!mean.allFinite() || !std.allFinite() || !(std(1) > 0.0)) return {};
  const Eigen::Vector2d stds(std::max(std(0), k_min_fraction * std(1)), std(1));
  if (transform.kind == ParameterTransform::Kind::identity) return normal_band(mean, stds, k_band_reach);
  const std::vector<TransformedMoments> pairs = moments_within(transform, mean, stds);
  if (pairs.empty()) return {};
  return band_of_variable(transform, pairs, k_band_reach);
}

}  // namespace mottle::study
