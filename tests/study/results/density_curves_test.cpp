#include "study/results/density_curves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/stats/distributions/transformed_moments.hpp"

namespace mottle::study {
namespace {

double normal_density(double x, double mean, double std) {
  const double z = (x - mean) / std;
  return std::exp(-0.5 * z * z) / (std * std::sqrt(2.0 * std::numbers::pi));
}

/// Height of a curve at x, between its points.
double height_at(const DensityCurve& curve, double x) {
  const auto after = std::lower_bound(curve.x.begin(), curve.x.end(), x) - curve.x.begin();
  const double part = (x - curve.x(after - 1)) / (curve.x(after) - curve.x(after - 1));
  return curve.density(after - 1) + part * (curve.density(after) - curve.density(after - 1));
}

constexpr double k_straight = 2e-3;  // relative, of curves of straight pieces

void expect_height(const DistributionSpec& spec, double x, double expected) {
  EXPECT_NEAR(height_at(prior_curve(Distribution(spec)), x), expected, k_straight * expected);
}

TEST(DensityCurves, OfPriorsHaveTheClosedDensitiesOfTheirFamilies) {
  expect_height({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.3}, 2.1, normal_density(2.1, 2.0, 0.3));
  expect_height({.kind = DistributionKind::uniform, .lower = 1.0, .upper = 3.0}, 1.7, 0.5);
  // Beta(2, 5) on [0, 1]: 30 x (1 - x)^4.
  expect_height({.kind = DistributionKind::beta,
                 .mean = 2.0 / 7.0,
                 .std = std::sqrt(10.0 / (49.0 * 8.0)),
                 .lower = 0.0,
                 .upper = 1.0},
                0.3, 30.0 * 0.3 * std::pow(0.7, 4));
  // Gamma of shape 4 and scale 1/2: 16 x^3 exp(-2 x) / 6.
  expect_height({.kind = DistributionKind::gamma, .mean = 2.0, .std = 1.0}, 2.0, 16.0 * 8.0 * std::exp(-4.0) / 6.0);
  // N(0, 1) cut to [-1, 2], which holds 0.8185946.
  expect_height({.kind = DistributionKind::truncated_normal, .mean = 0.0, .std = 1.0, .lower = -1.0, .upper = 2.0}, 0.1,
                normal_density(0.1, 0.0, 1.0) / 0.8185946141);
  const double mean = std::exp(0.02);
  expect_height({.kind = DistributionKind::lognormal, .mean = mean, .std = mean * std::sqrt(std::expm1(0.04))}, 1.0,
                normal_density(0.0, 0.0, 0.2));
}

TEST(DensityCurves, OfNoWidthAreNone) {
  EXPECT_EQ(normal_curve(1.0, 0.0).x.size(), 0);
  EXPECT_EQ(normal_curve(std::nan(""), 1.0).x.size(), 0);
}

TEST(DensityBand, HoldsEveryDensityThatItsIntervalsAllowAndTouchesSome) {
  for (const ParameterTransform::Kind kind : {ParameterTransform::Kind::identity, ParameterTransform::Kind::log}) {
    const ParameterTransform scale{kind};
    const DensityBand band = density_band(scale, {0.9, 1.1}, {0.1, 0.3});
    const double slack =
        kind == ParameterTransform::Kind::identity ? 1e-12 : 0.12;  // beside pairs of a grid is a little more
    for (Eigen::Index k = 0; k < band.x.size(); ++k) {
      double lower = std::numeric_limits<double>::infinity();
      double upper = 0.0;
      for (int i = 0; i <= 40; ++i) {
        for (int j = 0; j <= 40; ++j) {
          const auto moments = moments_of_transformed(scale, 0.9 + 0.005 * i, 0.1 + 0.005 * j);
          const double density = density_of_variable(scale, *moments, band.x(k));
          lower = std::min(lower, density);
          upper = std::max(upper, density);
        }
      }
      EXPECT_LE(band.lower(k), lower + slack);
      EXPECT_GE(band.upper(k), upper - slack);
      EXPECT_NEAR(band.lower(k), lower, 0.05);
      EXPECT_NEAR(band.upper(k), upper, 0.12);
    }
  }
}

TEST(DensityBand, OfAnIntervalThatIsNotKnownOrHasNoWidthIsNone) {
  EXPECT_EQ(density_band({}, {std::nan(""), 1.0}, {0.1, 0.3}).x.size(), 0);
  EXPECT_EQ(density_band({}, {0.9, 1.0}, {0.0, 0.0}).x.size(), 0);
}

}  // namespace
}  // namespace mottle::study
