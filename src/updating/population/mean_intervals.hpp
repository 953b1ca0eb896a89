// How well an estimate from the mean of many specimens knows the mean of the population.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Sampling covariance of the mean of the tests about the model's, C / n + D, from that of one test, C [output x
/// output], and a given error D of the model, which all specimens have in common.
Eigen::MatrixXd covariance_of_tests_mean(const TestData& tests, const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// How an estimate follows the mean z of the tests.
struct MeanEstimator {
  Eigen::VectorXd mean;              ///< the estimate, on the parameters' own axes [parameter]
  Eigen::MatrixXd gain;              ///< K = dx/dz [parameter x output]
  Eigen::MatrixXd prior_covariance;  ///< of what the prior adds to the error of `mean`; zero: nothing
  /// By which the variance K V K' / n of one sample grows since K was made with V; see weighted_by_tests().
  double inflation = 1.0;
  double degrees_of_freedom = std::numeric_limits<double>::quiet_NaN();  ///< of V; nan: one less than the specimens
};

/// A gain K = (G' V^-1 G)^-1 G' V^-1 of the sample covariance V itself: inflation (1 + T^2 / (n - 1)) (n - 1) / f with
/// f = n - 1 - (p - q) degrees of freedom, T^2 = n r' V^-1 r of the residual r = z - f(x); exact for a linear model
/// and a normal population. f < 1 leaves nothing to know the variance by: no interval.
/// Source: [Rao1967].
///
/// @param distance  r' V^-1 r
void set_weighted_by_tests(const TestData& tests, double distance, MeanEstimator& estimator);

/// Covariance of the mean's error, K (c V / n + D) K' + prior_covariance: V the tests' covariance, its variances at
/// least those of the stated noise; n the specimens of each output; c the inflation; D a given error of the model.
Eigen::MatrixXd covariance_of_mean(const TestData& tests, const MeanEstimator& estimator);

/// Its 95 % intervals: Student's t. What does not shrink with n counts as known: f (v / (v - v_known))^2 degrees of
/// freedom [Satterthwaite1946]. Standard deviations and correlations of the population: nan.
ParameterIntervals intervals_of_mean(const TestData& tests, const MeanEstimator& estimator);

}  // namespace mottle::updating
