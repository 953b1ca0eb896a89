#include "updating/population/mean_intervals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {
namespace {

TEST(MeanIntervals, AreStudentsOfOneOutput) {
  Eigen::MatrixXd values(5, 1);
  values << 4.1, 3.8, 4.4, 4.0, 4.2;
  const TestData tests{values, Eigen::VectorXd::Zero(1)};
  MeanEstimator estimator{Eigen::VectorXd::Constant(1, 8.2), Eigen::MatrixXd::Constant(1, 1, 2.0),
                          Eigen::MatrixXd::Zero(1, 1)};
  // scipy.stats.t.interval(0.95, 4, 4.1, scipy.stats.sem(values)), doubled
  const ParameterIntervals found = intervals_of_mean(tests, estimator);
  EXPECT_NEAR(found.mean(0, 0), 2.0 * 3.8223554895, 1e-8);
  EXPECT_NEAR(found.mean(0, 1), 2.0 * 4.3776445105, 1e-8);
  EXPECT_TRUE(std::isnan(found.std(0, 0)));
}

/// Four outputs of two parameters, y = G x, and the covariance of what a specimen adds.
struct LinearPopulation {
  LinearPopulation() : g(4, 2) {
    g << 1.0, 0.2, -0.5, 1.0, 0.7, 0.7, 0.1, -1.2;
    Eigen::Matrix4d root;
    root << 1.0, 0.0, 0.0, 0.0, 0.6, 0.5, 0.0, 0.0, -0.3, 0.4, 2.0, 0.0, 0.2, 0.9, -0.7, 0.3;
    covariance_root = root;
  }
  Eigen::MatrixXd draw(int specimens, std::uint32_t set) const {
    RandomStream stream({.seed = 7, .purpose = StreamPurpose::bootstrap}, set);
    Eigen::MatrixXd values(specimens, 4);
    for (double& value : values.reshaped()) value = standard_normal_quantile(stream.uniform());
    return (values * covariance_root.transpose()).rowwise() + (g * truth).transpose();
  }
  Eigen::MatrixXd g;
  Eigen::Vector2d truth{1.0, -2.0};
  Eigen::MatrixXd covariance_root;
};

constexpr int k_sets = 4000;
constexpr double k_three_errors = 0.0104;  // 3 sqrt(0.95 0.05 / 4000)

/// Share of sets whose intervals hold the truth, by parameter; the gain is that of weighted least squares.
Eigen::Vector2d coverage(int specimens, bool is_weighted_by_tests, bool is_corrected) {
  const LinearPopulation population;
  Eigen::Array2d held = Eigen::Array2d::Zero();
  for (std::uint32_t set = 0; set < k_sets; ++set) {
    const TestData tests{population.draw(specimens, set), Eigen::VectorXd::Zero(4)};
    const Eigen::VectorXd mean = tests.values.colwise().mean();
    const Eigen::MatrixXd weight = is_weighted_by_tests ? Eigen::MatrixXd(sample_covariance(tests.values).inverse())
                                                        : Eigen::MatrixXd(Eigen::Vector4d(1, 2, 3, 4).asDiagonal());
    const Eigen::MatrixXd gw = population.g.transpose() * weight;
    MeanEstimator estimator{{}, (gw * population.g).inverse() * gw, Eigen::MatrixXd::Zero(2, 2)};
    estimator.mean = estimator.gain * mean;
    const Eigen::VectorXd residual = mean - population.g * estimator.mean;
    if (is_corrected) set_weighted_by_tests(tests, residual.dot(weight * residual), estimator);
    const ParameterIntervals found = intervals_of_mean(tests, estimator);
    held +=
        (found.mean.col(0).array() <= population.truth.array() && population.truth.array() <= found.mean.col(1).array())
            .cast<double>();
  }
  return held / k_sets;
}

TEST(MeanIntervals, HoldTheMeanOfAPopulationInNineteenOfTwentySets) {
  for (const int specimens : {3, 8}) {
    EXPECT_LT((coverage(specimens, false, false).array() - 0.95).abs().maxCoeff(), k_three_errors) << specimens;
  }
}

TEST(MeanIntervals, WeightedByTheTestsThemselvesHoldItOnlyWithTheirFactor) {
  for (const int specimens : {6, 10}) {
    EXPECT_LT((coverage(specimens, true, true).array() - 0.95).abs().maxCoeff(), k_three_errors) << specimens;
  }
  EXPECT_LT(coverage(6, true, false).maxCoeff(), 0.9);
}

TEST(MeanIntervals, OfTooFewSpecimensForTheirWeightAreNotDetermined) {
  const LinearPopulation population;
  const TestData tests{population.draw(3, 0), Eigen::VectorXd::Zero(4)};
  MeanEstimator estimator{population.truth, Eigen::MatrixXd::Ones(2, 4), Eigen::MatrixXd::Zero(2, 2)};
  set_weighted_by_tests(tests, 1.0, estimator);
  EXPECT_TRUE(intervals_of_mean(tests, estimator).mean.array().isNaN().all());
}

TEST(MeanIntervals, KeepWhatAllSpecimensShareAndTheStatedNoise) {
  // Copies of one specimen: the noise is what is left, and a given error of the model does not shrink with them.
  TestData tests{Eigen::MatrixXd::Constant(16, 1, 3.0), Eigen::VectorXd::Constant(1, 0.4)};
  MeanEstimator estimator{Eigen::VectorXd::Constant(1, 3.0), Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Zero(1, 1)};
  EXPECT_NEAR(covariance_of_mean(tests, estimator)(0, 0), 0.01, 1e-15);
  tests.model_error_std = Eigen::VectorXd::Constant(1, 0.3);
  EXPECT_NEAR(covariance_of_mean(tests, estimator)(0, 0), 0.10, 1e-15);
  const ParameterIntervals found = intervals_of_mean(tests, estimator);
  // scipy.stats.t.ppf(0.975, 15 * (0.1 / 0.01) ** 2) * 0.1 ** 0.5
  EXPECT_NEAR(found.mean(0, 1) - 3.0, 0.6202955479, 1e-8);
}

}  // namespace
}  // namespace mottle::updating
