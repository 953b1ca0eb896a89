#include "mottle/updating/estimate/sample_estimate.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/sampling/sampling.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"

namespace mottle::updating {
namespace {

const std::vector<ParameterTransform> k_two(2);

/// A sample of a normal population of two parameters, correlation 0.6.
Eigen::MatrixXd normal_sample(Eigen::Index count) {
  Eigen::Matrix2d covariance;
  covariance << 0.04, 0.036, 0.036, 0.09;
  const NormalPopulation population(k_two, {Eigen::Vector2d(1.0, 2.0), covariance, {}}, 0);
  const StreamKey key{.seed = 7, .purpose = StreamPurpose::truth};
  return population.from_uniform(uniform_design(SamplingDesign::sobol, count, 2, key));
}

TEST(SampleEstimate, HasTheMomentsOfItsSamplesWithEqualWeights) {
  const Eigen::MatrixXd samples = normal_sample(50);
  const SampleEstimate estimate(k_two, samples);
  EXPECT_LT((estimate.mean() - sample_mean(samples)).norm(), 1e-14);
  EXPECT_LT((estimate.covariance() - 49.0 / 50.0 * sample_covariance(samples)).norm(), 1e-14);
  EXPECT_NEAR(*estimate.effective_samples(), 50.0, 1e-10);
}

TEST(SampleEstimate, TakesAWeightForAsManyCopies) {
  Eigen::MatrixXd few(3, 1);
  few << 1.0, 2.0, 4.0;
  const SampleEstimate estimate({ParameterTransform{}}, few, Eigen::Vector3d(2.0, 1.0, 1.0));
  EXPECT_NEAR(estimate.mean()(0), (1.0 + 1.0 + 2.0 + 4.0) / 4.0, 1e-15);
  EXPECT_NEAR(estimate.covariance()(0, 0), (1.0 + 1.0 + 0.0 + 4.0) / 4.0, 1e-14);
}

TEST(SampleEstimate, HasQuantilesLinearBetweenItsSamples) {
  Eigen::MatrixXd few(4, 1);
  few << 4.0, 1.0, 3.0, 2.0;
  const SampleEstimate estimate({ParameterTransform{}}, few);
  EXPECT_NEAR(estimate.quantile(0, 0.5), 2.5, 1e-15);
  EXPECT_NEAR(estimate.quantile(0, 0.375), 2.0, 1e-15);
  EXPECT_EQ(estimate.quantile(0, 0.01), 1.0);
  EXPECT_EQ(estimate.quantile(0, 0.99), 4.0);
}

TEST(SampleEstimate, HasTheQuantilesOfALargeNormalSample) {
  const SampleEstimate estimate(k_two, normal_sample(1 << 14));
  EXPECT_NEAR(estimate.quantile(0, 0.025), 1.0 - 0.2 * 1.959964, 2e-3);
  EXPECT_NEAR(estimate.quantile(1, 0.84), 2.0 + 0.3 * 0.994458, 2e-3);
}

/// Kernels of width h make N(m, s^2) into N(m, s^2 + h^2).
TEST(SampleEstimate, HasTheDensityOfALargeNormalSampleWidenedByTheKernels) {
  constexpr Eigen::Index k_count = 1 << 14;
  const SampleEstimate estimate(k_two, normal_sample(k_count));
  const double h = 0.9 * 0.2 * std::pow(static_cast<double>(k_count), -0.2);
  const double width = std::hypot(0.2, h);
  for (const double z : {-2.0, -0.5, 0.0, 1.0}) {
    const double expected = std::exp(-0.5 * z * z) / (width * std::sqrt(2.0 * std::numbers::pi));
    EXPECT_NEAR(estimate.density(0, Eigen::VectorXd::Constant(1, 1.0 + width * z))(0), expected, 0.01 * expected);
  }
}

TEST(SampleEstimate, HasNoDensityBeyondItsScale) {
  const ParameterTransform scale{ParameterTransform::Kind::log};
  Eigen::MatrixXd samples(3, 1);
  samples << 0.01, 0.1, 0.2;
  const SampleEstimate estimate({scale}, samples);
  EXPECT_TRUE(estimate.density(0, Eigen::Vector2d(-0.1, 0.0)).isZero(0.0));
  EXPECT_GT(estimate.density_points(0, 51).minCoeff(), 0.0);
}

TEST(SampleEstimate, HasADensityOfAreaOne) {
  const SampleEstimate estimate(k_two, normal_sample(500));
  const Eigen::VectorXd points = estimate.density_points(1, 501);
  const Eigen::VectorXd density = estimate.density(1, points);
  double sum = 0.0;
  for (Eigen::Index k = 1; k < points.size(); ++k) {
    sum += 0.5 * (points(k) - points(k - 1)) * (density(k) + density(k - 1));
  }
  EXPECT_NEAR(sum, 1.0, 1e-3);
}

TEST(SampleEstimate, HasTheRegionsOfALargeNormalSample) {
  const SampleEstimate estimate(k_two, normal_sample(1 << 14));
  Eigen::Matrix2d c;
  c << 0.04, 0.036, 0.036, 0.09;
  const Eigen::MatrixXd outline = estimate.region(0, 1, 0.864664717, 33).front();  // 2 deviations
  for (Eigen::Index k = 0; k < outline.rows(); ++k) {
    const Eigen::Vector2d apart = outline.row(k).transpose() - Eigen::Vector2d(1.0, 2.0);
    EXPECT_NEAR(std::sqrt(apart.dot(c.inverse() * apart)), 2.0,
                0.15);  // as tests/stats/moments/density_region_test.cpp
  }
}

TEST(SampleEstimate, DrawsItsSamplesByTheirWeights) {
  Eigen::MatrixXd few(3, 2);
  few << 1.0, 10.0, 2.0, 20.0, 3.0, 30.0;
  const SampleEstimate estimate(k_two, few, Eigen::Vector3d(0.5, 0.0, 0.5));
  Eigen::MatrixXd uniforms(3, 2);
  uniforms << 0.499, 0.9, 0.501, 0.1, 0.999, 0.5;
  const Eigen::MatrixXd drawn = estimate.from_uniform(uniforms);
  EXPECT_EQ(Eigen::MatrixXd(drawn.row(0)), Eigen::MatrixXd(few.row(0)));
  EXPECT_EQ(Eigen::MatrixXd(drawn.row(1)), Eigen::MatrixXd(few.row(2)));
  EXPECT_EQ(Eigen::MatrixXd(drawn.row(2)), Eigen::MatrixXd(few.row(2)));
}

TEST(SampleEstimate, HasNoWidthWithOneSample) {
  const SampleEstimate estimate(k_two, Eigen::MatrixXd::Ones(1, 2));
  EXPECT_TRUE(estimate.covariance().isZero(0.0));
  EXPECT_EQ(estimate.density_points(0, 11).size(), 0);
  EXPECT_TRUE(estimate.region(0, 1, 0.5, 9).empty());
}

TEST(SampleEstimate, RefusesWhatIsNoSample) {
  EXPECT_THROW(SampleEstimate(k_two, Eigen::MatrixXd(0, 2)), InvalidInput);
  EXPECT_THROW(SampleEstimate(k_two, Eigen::MatrixXd::Ones(2, 2), Eigen::Vector2d(0.0, 0.0)), InvalidInput);
  EXPECT_THROW(SampleEstimate(k_two, Eigen::MatrixXd::Ones(2, 2), Eigen::Vector2d(-1.0, 2.0)), InvalidInput);
  EXPECT_THROW(SampleEstimate({ParameterTransform{ParameterTransform::Kind::log}}, -Eigen::MatrixXd::Ones(1, 1)),
               InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
