#include "updating/population/mean_intervals.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/stats/population/population_intervals.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Of one test: that of the sample, its variances at least those of the stated noise.
Eigen::MatrixXd covariance_of_test(const TestData& tests) {
  Eigen::MatrixXd covariance = test_moments(tests).covariance;
  covariance.diagonal() = covariance.diagonal().cwiseMax(tests.repeatability_std.cwiseAbs2());
  return covariance;
}

/// The part of covariance_of_mean() that does not shrink with the number of specimens.
Eigen::MatrixXd known_part(const TestData& tests, const MeanEstimator& estimator) {
  return estimator.gain * tests.model_error_variance().asDiagonal() * estimator.gain.transpose() +
         estimator.prior_covariance;
}

double degrees_of_freedom_of(const TestData& tests, const MeanEstimator& estimator) {
  if (!std::isnan(estimator.degrees_of_freedom)) return estimator.degrees_of_freedom;
  return static_cast<double>(test_moments(tests).count.minCoeff()) - 1.0;
}

}  // namespace

Eigen::MatrixXd covariance_of_tests_mean(const TestData& tests, const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  const Eigen::MatrixXd measured = (!tests.values.array().isNaN()).cast<double>();
  const Eigen::MatrixXd together = measured.transpose() * measured;
  const Eigen::VectorXd count = together.diagonal().cwiseMax(1.0);
  Eigen::MatrixXd result =
      count.cwiseInverse().asDiagonal() * covariance.cwiseProduct(together) * count.cwiseInverse().asDiagonal();
  result.diagonal() += tests.model_error_variance();
  return result;
}

void set_weighted_by_tests(const TestData& tests, double distance, MeanEstimator& estimator) {
  const double n = test_moments(tests).count.minCoeff();
  const auto spent = static_cast<double>(estimator.gain.cols() - estimator.gain.rows());
  estimator.degrees_of_freedom = n - 1.0 - spent;
  estimator.inflation = (1.0 + n * distance / (n - 1.0)) * (n - 1.0) / std::max(estimator.degrees_of_freedom, 1.0);
}

Eigen::MatrixXd covariance_of_mean(const TestData& tests, const MeanEstimator& estimator) {
  const Eigen::MatrixXd of_tests = covariance_of_tests_mean(tests, estimator.inflation * covariance_of_test(tests));
  const Eigen::MatrixXd covariance =
      estimator.gain * of_tests * estimator.gain.transpose() + estimator.prior_covariance;
  return 0.5 * (covariance + covariance.transpose());
}

ParameterIntervals intervals_of_mean(const TestData& tests, const MeanEstimator& estimator) {
  const Eigen::Index q = estimator.mean.size();
  const double degrees_of_freedom = degrees_of_freedom_of(tests, estimator);
  ParameterIntervals intervals{.mean = Eigen::MatrixXd::Constant(q, 2, k_nan),
                               .std = Eigen::MatrixXd::Constant(q, 2, k_nan),
                               .correlation_lower = Eigen::MatrixXd::Constant(q, q, k_nan),
                               .correlation_upper = Eigen::MatrixXd::Constant(q, q, k_nan),
                               .made_by = "analytic"};
  intervals.correlation_lower.diagonal().setOnes();
  intervals.correlation_upper.diagonal().setOnes();
  if (degrees_of_freedom < 1.0) return intervals;
  const Eigen::MatrixXd covariance = covariance_of_mean(tests, estimator);
  const Eigen::MatrixXd known = known_part(tests, estimator);
  // One parameter at a time: nothing is known of their scatter, and nothing asked.
  for (Eigen::Index i = 0; i < q; ++i) {
    if (!(covariance(i, i) > 0.0)) continue;
    const auto of = [i](const Eigen::MatrixXd& matrix) { return Eigen::MatrixXd(matrix.block(i, i, 1, 1)); };
    const PopulationEvidence evidence{.mean = estimator.mean.segment(i, 1),
                                      .total = of(covariance),
                                      .noise = Eigen::MatrixXd::Zero(1, 1),
                                      .mean_covariance = of(covariance),
                                      .degrees_of_freedom = Eigen::MatrixXd::Constant(1, 1, degrees_of_freedom),
                                      .mean_shared = of(known)};
    intervals.mean.row(i) = population_intervals(evidence, {ParameterTransform{}}, k_confidence).mean;
  }
  return intervals;
}

}  // namespace mottle::updating
