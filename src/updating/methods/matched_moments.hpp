// Tests of an update that matched the means of the tests, and perhaps their scatter, by its cloud.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mottle/layers.hpp"
#include "updating/methods/matched_residuals.hpp"
#include "updating/methods/mean_limits.hpp"
#include "updating/verdict/simulated_law.hpp"

namespace mottle::updating {

/// An estimate whose cloud is the last of the result's history.
struct MatchedEstimate {
  /// What the covariance of the parameters is: not the specimens' scatter; that without the known noise; that with it.
  enum class Scatter { not_estimated, without_noise, with_noise };

  std::string method;
  Eigen::VectorXd mean;         ///< on the parameters' scales [parameter]
  Eigen::MatrixXd sensitivity;  ///< dy/dt there [output x parameter]
  Scatter scatter = Scatter::not_estimated;
  /// Outputs' means of specimens that scatter as the tests do; nan: not known; empty: those of the cloud [output].
  Eigen::VectorXd means = {};
  /// Where the noise is known: means and residuals are those of each specimen in its own unmoved directions, which do
  /// not depend on the estimate's scatter.
  bool is_by_specimen = false;
  /// Of scatter-agreement; without studies it has its closed law.
  StudiedStatistic cloud_scatter = {};
};

inline constexpr const char* k_curvature_unknown =
    "The means were not tested: the model fails one standard deviation of the specimens' scatter away from the "
    "mean, so the effect of that scatter on the means of curved outputs is not known.";

/// Why a method that takes means and covariances output by output leaves an aspect untested where entries are missing:
/// the parameters' scatter does not cancel in differences of outputs that other specimens have.
std::string gaps_untested(Aspect aspect, const std::string& method);

/// Sampling covariance of the mean of the tests about the model's, C / n + D, from that of one test, C [output x
/// output], and a given error D of the model, which all specimens have in common.
Eigen::MatrixXd covariance_of_tests_mean(const TestData& tests, const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// Puts the tests of the estimate into the result, which must have its history:
///
///   mean-agreement: means of tests and cloud in the p - q directions B that no parameter moves,
///     r' B (B' M B)^-1 B' r,  r = z - y: chi-squared with p - q degrees of freedom, M = (C + R) / n + C / N, where the
///     noise R is known; Hotelling's T^2 with (p - q, n - 1), M = V / n + C / N, where it is not;
///   scatter-of-residuals: tr[(B' (C + R) B)^-1 B' V B] (n - 1) against chi-squared (noise known); where the model has
///   an
///     error, G is that of a displaced mean: the squares of MeanResiduals then, from fits of every specimen;
///   scatter-agreement, bounds, prior-shift: see cloud_agreement.hpp, mean_limits.hpp.
///
/// By specimen: mean-residuals in place of mean-agreement, and the squares of MeanResiduals. A statistic that was
/// simulated has the law of its simulations instead (simulated_law.hpp).
///
/// z, V: mean and covariance of n tests; y, C: of the N samples of the cloud; G = dy/dt.
void test_matched_moments(const UpdatingProblem& problem, const MatchedEstimate& estimate, const RunContext& context,
                          UpdatingResult& result);

}  // namespace mottle::updating
