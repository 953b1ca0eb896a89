#include "mottle/updating/estimate/normal_estimates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {
namespace {

const ParameterTransform k_log{ParameterTransform::Kind::log};
const ParameterTransform k_logit{ParameterTransform::Kind::logit, 1.0, 4.0};

/// A population of an identity, a log and a logit parameter.
NormalPopulation mixed_population() {
  Eigen::Matrix3d covariance;
  covariance << 0.09, 0.03, 0.0, 0.03, 0.04, -0.03, 0.0, -0.03, 0.25;
  return {{ParameterTransform{}, k_log, k_logit}, {Eigen::Vector3d(2.0, 0.3, -0.5), covariance, {}}, 0};
}

/// By the trapezoidal rule over the points that the estimate itself would draw.
double area(const Estimate& estimate, Eigen::Index parameter) {
  const Eigen::VectorXd points = estimate.density_points(parameter, 4001);
  const Eigen::VectorXd density = estimate.density(parameter, points);
  double sum = 0.0;
  for (Eigen::Index k = 1; k < points.size(); ++k) {
    sum += 0.5 * (points(k) - points(k - 1)) * (density(k) + density(k - 1));
  }
  return sum;
}

TEST(NormalPopulation, HasTheMomentsOfItsScales) {
  const NormalPopulation population = mixed_population();
  EXPECT_NEAR(population.mean()(0), 2.0, 1e-15);
  EXPECT_NEAR(population.mean()(1), std::exp(0.3 + 0.02), 1e-14);
  EXPECT_NEAR(population.covariance()(1, 1), std::exp(0.64) * std::expm1(0.04), 1e-14);
}

TEST(NormalPopulation, HasTheTabulatedDensitiesOfItsFamilies) {
  const NormalPopulation population = mixed_population();
  const double peak = 1.0 / std::sqrt(2.0 * std::numbers::pi);
  EXPECT_NEAR(population.density(0, Eigen::VectorXd::Constant(1, 2.3))(0), std::exp(-0.5) * peak / 0.3, 1e-14);
  // Lognormal: phi((ln x - 0.3) / 0.2) / (0.2 x).
  EXPECT_NEAR(population.density(1, Eigen::VectorXd::Constant(1, 1.0))(0), std::exp(-1.125) * peak / 0.2, 1e-14);
  // Logit-normal at its median: phi(0) / (0.5 dx/dt), dx/dt = 3 s (1 - s), s = 1 / (1 + e^0.5).
  const double s = 1.0 / (1.0 + std::exp(0.5));
  EXPECT_NEAR(population.density(2, Eigen::VectorXd::Constant(1, 1.0 + 3.0 * s))(0), peak / (1.5 * s * (1.0 - s)),
              1e-13);
  EXPECT_TRUE(population.density(1, Eigen::Vector2d(-1.0, 0.0)).isZero(0.0));
  EXPECT_TRUE(population.density(2, Eigen::Vector3d(0.9, 1.0, 4.0)).isZero(0.0));
}

TEST(NormalPopulation, HasDensitiesOfAreaOne) {
  // Four deviations hold all but 6e-5.
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(area(mixed_population(), i), 1.0, 1e-4);
}

TEST(NormalPopulation, HasTheTabulatedQuantilesOnItsScales) {
  const NormalPopulation population = mixed_population();
  EXPECT_NEAR(population.quantile(0, 0.975), 2.0 + 0.3 * 1.959963984540054, 1e-12);
  EXPECT_NEAR(population.quantile(1, 0.16), std::exp(0.3 - 0.2 * 0.994457883209753), 1e-12);
  EXPECT_NEAR(population.quantile(2, 0.5), 1.0 + 3.0 / (1.0 + std::exp(0.5)), 1e-12);
}

TEST(NormalPopulation, IsInARegionWithItsProbability) {
  const NormalPopulation population = mixed_population();
  const StreamKey key{.seed = 2, .purpose = StreamPurpose::truth};
  const Eigen::MatrixXd t =
      from_variables({ParameterTransform{}, k_log, k_logit},
                     population.from_uniform(uniform_design(SamplingDesign::sobol, 1 << 14, 3, key)));
  // A linear map takes the outline of a pair to a circle about the mean, of the radius that the probability asks.
  const Eigen::MatrixXd outline = population.region(0, 1, 0.9, 49).front();
  EXPECT_EQ(Eigen::MatrixXd(outline.row(0)), Eigen::MatrixXd(outline.row(48)));
  const Eigen::Matrix2d c = (Eigen::Matrix2d() << 0.09, 0.03, 0.03, 0.04).finished();
  for (Eigen::Index k = 0; k < 49; ++k) {
    const Eigen::Vector2d apart(outline(k, 0) - 2.0, std::log(outline(k, 1)) - 0.3);
    EXPECT_NEAR(apart.dot(c.inverse() * apart), -2.0 * std::log(0.1), 1e-11);
  }
  Eigen::Index inside = 0;
  for (Eigen::Index s = 0; s < t.rows(); ++s) {
    const Eigen::Vector2d apart(t(s, 0) - 2.0, t(s, 1) - 0.3);
    inside += apart.dot(c.inverse() * apart) <= -2.0 * std::log(0.1) ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(t.rows()), 0.9, 0.005);
}

TEST(NormalPopulation, HasItsCorrelationsOnItsScales) {
  EXPECT_NEAR(mixed_population().correlation()(1, 2), -0.3, 1e-14);
}

TEST(NormalPopulation, WithoutScatterHasNeitherDensityNorRegion) {
  const NormalPopulation known({ParameterTransform{}, ParameterTransform{}},
                               {Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(0.0, 1.0).asDiagonal(), {}}, 0);
  EXPECT_EQ(known.density_points(0, 11).size(), 0);
  EXPECT_TRUE(known.region(0, 1, 0.5, 9).empty());
  EXPECT_TRUE(std::isnan(known.correlation()(0, 1)));
  EXPECT_EQ(known.quantile(0, 0.975), 1.0);
}

TEST(MomentEstimate, HasDensitiesWithItsMomentsOnEveryScale) {
  const Eigen::Vector3d mean(2.0, 1.4, 3.7);
  const Eigen::Vector3d standard_deviation(0.3, 0.4, 0.15);
  const MomentEstimate estimate({ParameterTransform{}, k_log, k_logit}, mean,
                                standard_deviation.cwiseAbs2().asDiagonal());
  EXPECT_EQ(estimate.mean(), mean);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::VectorXd points = estimate.density_points(i, 8001);
    const Eigen::VectorXd density = estimate.density(i, points);
    double first = 0.0;
    double second = 0.0;
    for (Eigen::Index k = 1; k < points.size(); ++k) {
      const double width = points(k) - points(k - 1);
      const double x = 0.5 * (points(k) + points(k - 1));
      const double mass = 0.5 * width * (density(k) + density(k - 1));
      first += x * mass;
      second += (x - mean(i)) * (x - mean(i)) * mass;
    }
    EXPECT_NEAR(first, mean(i), 3e-4 * mean(i));  // 6e-5 of the mass lie beyond the points
    EXPECT_NEAR(std::sqrt(second), standard_deviation(i), 2e-3 * standard_deviation(i));
  }
}

TEST(MomentEstimate, DrawsFromTheNormalDistributionOfItsMoments) {
  const MomentEstimate estimate({k_log}, Eigen::VectorXd::Constant(1, 1.0), Eigen::MatrixXd::Constant(1, 1, 0.25));
  const Eigen::MatrixXd drawn = estimate.from_uniform(Eigen::MatrixXd::Constant(1, 1, 0.8413447460685429));
  EXPECT_NEAR(drawn(0, 0), 1.5, 1e-12);
}

TEST(MomentEstimate, HasTheRegionsOfItsDraws) {
  const Eigen::Vector2d mean(1.0, 2.0);
  const Eigen::Matrix2d covariance = (Eigen::Matrix2d() << 0.25, 0.2, 0.2, 0.36).finished();
  const Eigen::MatrixXd outline =
      MomentEstimate({k_log, ParameterTransform{}}, mean, covariance).region(0, 1, 0.9, 33).front();
  for (Eigen::Index k = 0; k < 33; ++k) {
    const Eigen::Vector2d apart = outline.row(k).transpose() - mean;
    EXPECT_NEAR(apart.dot(covariance.inverse() * apart), -2.0 * std::log(0.1), 1e-11);
  }
}

TEST(MomentEstimate, WithoutAMatchOnItsScaleIsNormal) {
  const MomentEstimate estimate({k_log}, Eigen::VectorXd::Constant(1, -1.0), Eigen::MatrixXd::Constant(1, 1, 0.25));
  EXPECT_NEAR(estimate.quantile(0, 0.5), -1.0, 1e-15);
}

}  // namespace
}  // namespace mottle::updating
