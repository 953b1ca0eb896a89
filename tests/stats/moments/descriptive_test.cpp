#include "mottle/stats/moments/descriptive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

constexpr double k_missing = std::numeric_limits<double>::quiet_NaN();

Eigen::MatrixXd samples_with_gaps() {
  return (Eigen::MatrixXd(6, 3) << 1.0, 2.0, 0.5, 2.0, k_missing, 1.5, 3.0, 1.0, k_missing, 4.0, 5.0, 2.5, k_missing,
          4.0, 3.0, 2.5, 3.5, 1.0)
      .finished();
}

TEST(SampleMoments, MeanAndCovarianceOfASmallSampleAreThoseByHand) {
  const Eigen::MatrixXd samples = (Eigen::MatrixXd(3, 2) << 1.0, 10.0, 2.0, 14.0, 6.0, 12.0).finished();
  EXPECT_EQ(sample_mean(samples), Eigen::Vector2d(3.0, 12.0));
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(2, 2) << 7.0, 1.0, 1.0, 4.0).finished();
  EXPECT_LT((sample_covariance(samples) - expected).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((sample_standard_deviation(samples) - Eigen::Vector2d(std::sqrt(7.0), 2.0)).norm(), 1e-14);
}

TEST(SampleMoments, CovarianceKeepsItsDigitsFarFromTheOrigin) {
  Eigen::MatrixXd samples(3, 1);
  samples << 1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0;
  EXPECT_EQ(sample_covariance(samples)(0, 0), 1.0);
}

TEST(SampleMoments, CovarianceRefusesOneRowAndMissingEntries) {
  EXPECT_THROW(static_cast<void>(sample_covariance(Eigen::MatrixXd::Ones(1, 2))), InvalidInput);
  EXPECT_THROW(static_cast<void>(sample_standard_deviation(Eigen::MatrixXd::Ones(1, 2))), InvalidInput);
  EXPECT_THROW(static_cast<void>(sample_covariance(samples_with_gaps())), InvalidInput);
  EXPECT_THROW(static_cast<void>(sample_mean(Eigen::MatrixXd(0, 2))), InvalidInput);
}

TEST(Correlation, IsCovarianceOverDeviationsAndZeroWithoutVariance) {
  Eigen::MatrixXd covariance(3, 3);
  covariance << 4.0, 3.0, 0.0, 3.0, 9.0, 0.0, 0.0, 0.0, 0.0;
  const Eigen::MatrixXd correlation = correlation_from_covariance(covariance);
  EXPECT_DOUBLE_EQ(correlation(0, 1), 0.5);
  EXPECT_EQ(correlation(0, 2), 0.0);
  EXPECT_EQ(correlation(2, 2), 1.0);
}

TEST(Correlation, RefusesANegativeVariance) {
  EXPECT_THROW(static_cast<void>(correlation_from_covariance(-Eigen::MatrixXd::Identity(2, 2))), InvalidInput);
  EXPECT_THROW(static_cast<void>(correlation_from_covariance(Eigen::MatrixXd::Ones(2, 3))), InvalidInput);
}

/// Deviations 1, 1e-6 and 1e6, correlations all one but for rounding that an eigenvalue of the covariance itself would
/// not show.
TEST(RepairedCovariance, IsPositiveInEveryUnitAndKeepsItsVariances) {
  const Eigen::Vector3d standard_deviation(1.0, 1e-6, 1e6);
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Ones();
  correlation(0, 1) = correlation(1, 0) = 1.0 - 1e-9;
  correlation(0, 2) = correlation(2, 0) = 1.0 + 1e-9;
  const Eigen::MatrixXd spoilt = standard_deviation.asDiagonal() * correlation * standard_deviation.asDiagonal();
  Eigen::MatrixXd covariance = spoilt;
  EXPECT_FALSE(repair_covariance(covariance));  // nothing but rounding
  EXPECT_EQ(covariance.diagonal(), spoilt.diagonal());
  EXPECT_EQ(covariance, Eigen::MatrixXd(covariance.transpose()));
  const Eigen::MatrixXd repaired =
      standard_deviation.cwiseInverse().asDiagonal() * covariance * standard_deviation.cwiseInverse().asDiagonal();
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(repaired).eigenvalues()(0), -1e-14);
  EXPECT_LT((repaired - correlation).cwiseAbs().maxCoeff(), 4e-9);
}

/// Two variables with a correlation of one: eigenvalues 2 and 0 become 2 and 2 c, scaled back to variances of 1 and 9.
TEST(RepairedCovariance, KeepsALeastEigenvalueWhereAskedTo) {
  constexpr double k_min = 1e-3;
  Eigen::MatrixXd covariance(2, 2);
  covariance << 1.0, 3.0, 3.0, 9.0;
  repair_covariance(covariance, k_min);
  EXPECT_NEAR(covariance(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(covariance(1, 1), 9.0, 1e-13);
  EXPECT_NEAR(covariance(0, 1), 3.0 * (1.0 - k_min) / (1.0 + k_min), 1e-13);
  const Eigen::MatrixXd mended = covariance;
  repair_covariance(covariance, k_min);
  EXPECT_EQ(covariance, mended);
}

TEST(RepairedCovariance, TakesAVariableWithoutVarianceOut) {
  Eigen::MatrixXd covariance(2, 2);
  covariance << -1e-20, 1e-12, 1e-12, 4.0;
  repair_covariance(covariance);
  EXPECT_EQ(covariance, (Eigen::MatrixXd(2, 2) << 0.0, 0.0, 0.0, 4.0).finished());
}

TEST(AvailableCases, CompleteSampleHasItsOrdinaryMoments) {
  const Eigen::MatrixXd samples = uniform_design(SamplingDesign::monte_carlo, 5, 8, {.seed = 4});
  const SampleMoments moments = available_case_moments(samples);
  EXPECT_LT((moments.mean - sample_mean(samples)).norm(), 1e-15);
  EXPECT_LT((moments.covariance - sample_covariance(samples)).norm(), 1e-14);
  EXPECT_FALSE(moments.was_repaired);
}

// NumPy: numpy.cov(rows that hold both columns, rowvar=False)[0, 1] for every pair.
TEST(AvailableCases, EveryMomentComesFromTheRowsThatHoldIt) {
  const SampleMoments moments = available_case_moments(samples_with_gaps());
  EXPECT_EQ(moments.count, Eigen::Vector3i(5, 5, 5));
  EXPECT_LT((moments.mean - Eigen::Vector3d(2.5, 3.1, 1.7)).norm(), 1e-15);
  Eigen::Matrix3d expected;
  expected << 1.25, 1.1875, 0.9791666666666666, 1.1875, 2.5500000000000003, 1.2083333333333333, 0.9791666666666666,
      1.2083333333333333, 1.075;
  EXPECT_LT((moments.covariance - expected).norm(), 1e-14);
  EXPECT_FALSE(moments.was_repaired);
}

// Three columns never measured all together, pairwise correlations -1 except one of +1: eigenvalues 2, 2, -1. Clipping
// leaves 2 (I - n n'), n = (1, -1, -1) / sqrt 3 up to signs, that is correlations of size 1/2.
TEST(AvailableCases, PairsThatContradictEachOtherAreProjectedKeepingTheVariances) {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Constant(12, 3, k_missing);
  samples.block(0, 0, 4, 2) << 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0;
  samples.block(4, 1, 4, 2) << 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0;
  for (Eigen::Index row = 8; row < 12; ++row) {
    samples(row, 0) = row % 2 == 0 ? 1.0 : -1.0;
    samples(row, 2) = -samples(row, 0);
  }
  const SampleMoments moments = available_case_moments(samples);
  EXPECT_TRUE(moments.was_repaired);
  EXPECT_TRUE(moments.covariance.diagonal().isApproxToConstant(8.0 / 7.0, 1e-14));
  const Eigen::MatrixXd correlation = correlation_from_covariance(moments.covariance);
  EXPECT_NEAR(correlation(0, 1), 0.5, 1e-12);
  EXPECT_NEAR(correlation(1, 2), 0.5, 1e-12);
  EXPECT_NEAR(correlation(0, 2), -0.5, 1e-12);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(moments.covariance);
  EXPECT_GT(eigen.eigenvalues()[0], -1e-14);
}

TEST(AvailableCases, PairNeverMeasuredTogetherHasNoCovariance) {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Constant(4, 2, k_missing);
  samples(0, 0) = 1.0;
  samples(1, 0) = 2.0;
  samples(2, 1) = 1.0;
  samples(3, 1) = 3.0;
  EXPECT_EQ(available_case_moments(samples).covariance(0, 1), 0.0);
}

TEST(AvailableCases, NamesTheColumnThatHoldsTooLittle) {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Random(4, 3);
  samples.col(2).head(3).setConstant(k_missing);
  try {
    static_cast<void>(available_case_moments(samples));
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("column 2 (from 0): 1 values"));
  }
  samples(0, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(static_cast<void>(available_case_moments(samples)), InvalidInput);
}

TEST(AvailableCases, CovarianceIsUnbiasedWhereEntriesAreMissingAtRandom) {
  constexpr int k_replications = 2000;
  const Eigen::MatrixXd truth = (Eigen::MatrixXd(2, 2) << 1.0, 0.5, 0.5, 1.0).finished();
  const JointDistribution normal = JointDistribution::multivariate_normal(Eigen::Vector2d::Zero(), truth);
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint32_t replication = 0; replication < k_replications; ++replication) {
    const StreamKey key{.seed = 9, .purpose = StreamPurpose::bootstrap, .iteration = replication};
    const Eigen::MatrixXd uniforms = uniform_design(SamplingDesign::monte_carlo, 20, 4, key);
    Eigen::MatrixXd samples = normal.from_uniform(uniforms.leftCols(2));
    samples = (uniforms.rightCols(2).array() < 0.25).select(k_missing, samples);
    const double covariance = available_case_moments(samples).covariance(0, 1);
    sum += covariance;
    squares += covariance * covariance;
  }
  const double mean = sum / k_replications;
  const double standard_error = std::sqrt((squares / k_replications - mean * mean) / k_replications);
  EXPECT_NEAR(mean, 0.5, 4.0 * standard_error);
}

}  // namespace
}  // namespace mottle::stats
