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
  /// Another centre of the specimens' fits, on the parameters' scales; the one whose residuals are smaller counts,
  /// since a method that ends beside the best parameters says nothing of the model. Empty: none [parameter].
  Eigen::VectorXd other_centre = {};
  /// Of scatter-agreement; without studies it has its closed law.
  StudiedStatistic cloud_scatter = {};
};

/// The estimate of a method that finds the mean alone. Its means are tested specimen by specimen where the noise is
/// known and the model has derivatives, so that the fits cost little; else with what curvature adds to second order.
///
/// @param mean  on the parameters' scales
MatchedEstimate matched_mean(const std::string& method, const UpdatingProblem& problem, const Eigen::VectorXd& mean,
                             const Eigen::MatrixXd& sensitivity, const RunContext& context, UpdatingResult& result);

/// Why a method that takes means and covariances output by output leaves an aspect untested where entries are missing:
/// the parameters' scatter does not cancel in differences of outputs that other specimens have.
std::string gaps_untested(Aspect aspect, const std::string& method);

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
