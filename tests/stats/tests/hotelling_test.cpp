#include "mottle/stats/tests/hotelling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/sampling/sampling.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

Eigen::MatrixXd sample_a() {
  return (Eigen::MatrixXd(6, 3) << 1.2, 0.4, 2.1, 0.9, 0.7, 1.8, 1.5, 0.1, 2.6, 1.1, 0.9, 2.0, 0.7, 0.3, 2.9, 1.3, 0.6,
          1.7)
      .finished();
}

Eigen::MatrixXd sample_b() {
  return (Eigen::MatrixXd(8, 3) << 1.0, 0.9, 2.4, 1.6, 1.1, 2.2, 1.4, 1.5, 3.0, 0.8, 0.8, 2.7, 1.9, 1.2, 1.9, 1.2, 1.6,
          2.5, 1.7, 0.7, 2.8, 1.1, 1.3, 2.3)
      .finished();
}

TwoSampleTest compare(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double alpha) {
  return hotelling_two_sample(sample_mean(a), sample_covariance(a), static_cast<int>(a.rows()), sample_mean(b),
                              sample_covariance(b), static_cast<int>(b.rows()), alpha);
}

std::string message_of_covariance(const Eigen::MatrixXd& covariance, int n_a, int n_b) {
  const Eigen::VectorXd mean = Eigen::VectorXd::Zero(covariance.rows());
  try {
    static_cast<void>(hotelling_two_sample(mean, covariance, n_a, mean, covariance, n_b, 0.05));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

// [Mares2006], Fig. 2, computed with SciPy: alpha = 0.05, p = 3, n1 + n2 on the axis.
TEST(HotellingCritical, ReproducesTheCurveOfThePaper) {
  EXPECT_NEAR(hotelling_t_critical(5, 5, 3, 0.05), 4.3621, 5e-5);
  EXPECT_NEAR(hotelling_t_critical(10, 10, 3, 0.05), 3.3062, 5e-5);
  EXPECT_NEAR(hotelling_t_critical(10, 40, 3, 0.05), 2.9642, 5e-5);
  EXPECT_NEAR(hotelling_t_critical(10, 90, 3, 0.05), 2.8752, 5e-5);
  EXPECT_NEAR(hotelling_t_critical(10, 990, 3, 0.05), 2.8031, 5e-5);
  EXPECT_NEAR(hotelling_t_critical(10, 1'000'000'000, 3, 0.05), 2.7955, 5e-5);
}

TEST(HotellingCritical, DependsOnTheSumOfTheSampleSizesAlone) {
  EXPECT_EQ(hotelling_t_critical(3, 17, 3, 0.05), hotelling_t_critical(10, 10, 3, 0.05));
}

// p = 1 is Student's t: SciPy 1.10, t.isf(.025, 18) = 2.10092204024096.
TEST(HotellingCritical, IsStudentsTForOneOutput) {
  EXPECT_TRUE(is_relatively_near(hotelling_t_critical(10, 10, 1, 0.05), 2.10092204024096, 1e-12));
}

TEST(HotellingCritical, RefusesTooFewSamplesAndAlphaOutsideItsRange) {
  EXPECT_NO_THROW(static_cast<void>(hotelling_t_critical(2, 3, 3, 0.05)));
  EXPECT_THROW(static_cast<void>(hotelling_t_critical(2, 2, 3, 0.05)), InvalidInput);
  EXPECT_THROW(static_cast<void>(hotelling_t_critical(0, 20, 3, 0.05)), InvalidInput);
  EXPECT_THROW(static_cast<void>(hotelling_t_critical(10, 10, 0, 0.05)), InvalidInput);
  EXPECT_THROW(static_cast<void>(hotelling_t_critical(10, 10, 3, 0.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(hotelling_t_critical(10, 10, 3, 1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(hotelling_t_critical(10, 10, 3, NAN)), InvalidInput);
}

// Bisection in Python with SciPy 1.10's f.isf and chi2.isf, n_test = 10, p = 3, alpha = 0.05.
TEST(SufficientSamples, AreThoseOfABisectionWithScipy) {
  EXPECT_EQ(sufficient_samples(10, 3, 0.05, 0.05), 50);
  EXPECT_EQ(sufficient_samples(10, 3, 0.05, 0.01), 266);
  EXPECT_EQ(sufficient_samples(10, 3, 0.05, 0.001), 2699);
}

TEST(SufficientSamples, AreTheFewestThatTheTestAllowsForAWideTolerance) {
  EXPECT_EQ(sufficient_samples(10, 3, 0.05, 1e9), 1);
  EXPECT_EQ(sufficient_samples(2, 10, 0.05, 1e9), 10);
}

TEST(SufficientSamples, RefusesAToleranceThatNoCloudReaches) {
  EXPECT_THROW(static_cast<void>(sufficient_samples(10, 3, 0.05, 0.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(sufficient_samples(10, 3, 0.05, 1e-12)), InvalidInput);
}

// NumPy and SciPy 1.10: S pooled, t2 = na nb / (na + nb) d @ solve(S, d), f = t2 (nu - p + 1) / (nu p),
// f.sf(f, p, nu - p + 1), f.isf(.05, p, nu - p + 1) nu p / (nu - p + 1).
TEST(HotellingTwoSample, StatisticAndProbabilityAreThoseOfScipy) {
  const TwoSampleTest test = compare(sample_a(), sample_b(), 0.05);
  EXPECT_TRUE(is_relatively_near(test.t_squared, 28.653218675593703, 1e-10));
  EXPECT_TRUE(is_relatively_near(test.f, 7.959227409887139, 1e-10));
  EXPECT_TRUE(is_relatively_near(test.p_value, 0.005265687445514182, 1e-10));
  EXPECT_TRUE(is_relatively_near(test.critical_t_squared, 13.349753348568637, 1e-10));
  EXPECT_EQ(test.df1, 3);
  EXPECT_EQ(test.df2, 10);
  EXPECT_TRUE(test.rejects);
}

TEST(HotellingTwoSample, RejectsExactlyWhereTheProbabilityFallsBelowAlpha) {
  const double p_value = compare(sample_a(), sample_b(), 0.5).p_value;
  EXPECT_TRUE(compare(sample_a(), sample_b(), 1.001 * p_value).rejects);
  EXPECT_FALSE(compare(sample_a(), sample_b(), 0.999 * p_value).rejects);
}

TEST(HotellingTwoSample, DoesNotDependOnTheUnitsOfTheOutputs) {
  const Eigen::Vector3d units(1e-9, 1.0, 1e12);
  const TwoSampleTest test = compare(sample_a() * units.asDiagonal(), sample_b() * units.asDiagonal(), 0.05);
  EXPECT_TRUE(is_relatively_near(test.t_squared, 28.653218675593703, 1e-10));
}

TEST(HotellingTwoSample, SampleOfOneNeedsNoCovariance) {
  const Eigen::MatrixXd b = sample_b();
  const Eigen::MatrixXd unread = Eigen::MatrixXd::Constant(3, 3, std::numeric_limits<double>::quiet_NaN());
  const Eigen::VectorXd difference = sample_a().row(0).transpose() - sample_mean(b);
  const TwoSampleTest test =
      hotelling_two_sample(sample_a().row(0).transpose(), unread, 1, sample_mean(b), sample_covariance(b), 8, 0.05);
  const double expected = 8.0 / 9.0 * difference.dot(sample_covariance(b).inverse() * difference);
  EXPECT_TRUE(is_relatively_near(test.t_squared, expected, 1e-12));
}

TEST(HotellingTwoSample, SaysHowManySamplesAreNeeded) {
  EXPECT_THAT(message_of_covariance(Eigen::MatrixXd::Identity(10, 10), 5, 6), ::testing::HasSubstr("at least 12"));
  EXPECT_EQ(message_of_covariance(Eigen::MatrixXd::Identity(10, 10), 6, 6), "accepted");
}

TEST(HotellingTwoSample, SaysThatTheCovarianceIsSingular) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Ones(2, 2);
  EXPECT_THAT(message_of_covariance(covariance, 10, 10), ::testing::HasSubstr("singular, the smallest eigenvalue"));
  covariance << 0.0, 0.0, 0.0, 1.0;
  EXPECT_THAT(message_of_covariance(covariance, 10, 10), ::testing::HasSubstr("singular, output 0"));
}

TEST(HotellingTwoSample, FalseAlarmRateIsAlpha) {
  constexpr int k_replications = 2000;
  constexpr double k_alpha = 0.05;
  Eigen::Matrix3d covariance;
  covariance << 4.0, 1.2, -0.6, 1.2, 2.0, 0.3, -0.6, 0.3, 1.0;
  const JointDistribution normal = JointDistribution::multivariate_normal(Eigen::Vector3d(1.0, 2.0, 3.0), covariance);
  int rejections = 0;
  for (std::uint32_t replication = 0; replication < k_replications; ++replication) {
    const StreamKey key{.seed = 1, .purpose = StreamPurpose::bootstrap, .iteration = replication};
    const Eigen::MatrixXd samples = normal.from_uniform(uniform_design(SamplingDesign::monte_carlo, 40, 3, key));
    if (compare(samples.topRows(10), samples.bottomRows(30), k_alpha).rejects) ++rejections;
  }
  const double standard_error = std::sqrt(k_alpha * (1.0 - k_alpha) / k_replications);
  EXPECT_NEAR(static_cast<double>(rejections) / k_replications, k_alpha, 4.0 * standard_error);
}

}  // namespace
}  // namespace mottle::stats
