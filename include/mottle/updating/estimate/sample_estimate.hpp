// An estimate that is a weighted sample, as methods that sample a posterior find it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"
#include "mottle/updating/estimate/estimate.hpp"

namespace mottle::updating {

/// Weighted samples of the parameters.
///
/// Covariance: sum w (x - m)(x - m)'. Quantiles: linear between the samples, each at the middle of its
/// weight. Densities: normal kernels on the parameters' scales, so that none lies beyond a bound, of bandwidth
///
///   h = 0.9 min(s, IQR / 1.34) n^(-1/5),   n = 1 / sum w^2
///
/// Regions: highest_density_outlines() on the scales; of samples on a line the part of it that holds `probability`.
/// Source: [Silverman1986], Eq. 3.31, for h; [Kish1965] for n.
class SampleEstimate final : public Estimate {
 public:
  /// @param scales        one a parameter
  /// @param samples       [sample x parameter], inside the scales
  /// @param weights       >= 0, not all zero; their sum does not matter; empty: all alike [sample]
  /// @param log_evidence  of the tests, where the method finds it
  /// @param effective     independent samples that correlated ones are worth; nothing: n above
  /// @throws InvalidInput  sizes that do not fit, no sample, an entry that is not finite or outside its scale
  SampleEstimate(std::vector<ParameterTransform> scales, Eigen::MatrixXd samples, const Eigen::VectorXd& weights = {},
                 std::optional<double> log_evidence = std::nullopt, std::optional<double> effective = std::nullopt);

  EstimateKind kind() const override { return EstimateKind::posterior; }
  Eigen::VectorXd mean() const override { return mean_; }
  Eigen::MatrixXd covariance() const override { return covariance_; }
  /// A sample by the first uniform of each row.
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const override;
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const override;
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const override;
  double quantile(Eigen::Index parameter, double probability) const override;
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override;
  std::string prediction_note() const override;
  std::optional<double> log_evidence() const override { return log_evidence_; }
  std::optional<double> effective_samples() const override { return effective_; }

 private:
  double bandwidth(Eigen::Index parameter) const;

  std::vector<ParameterTransform> scales_;
  Eigen::MatrixXd samples_;
  Eigen::VectorXd weights_;     // their sum is 1
  Eigen::VectorXd cumulative_;  // sums of the weights up to and with each sample
  Eigen::MatrixXd scaled_;      // samples on the scales
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd scaled_mean_;
  Eigen::MatrixXd scaled_covariance_;
  std::optional<double> log_evidence_;
  double effective_ = 0.0;
};

/// Quantile of weighted values: linear between them, each at the middle of its weight.
///
/// @param weights  of sum 1 [value]
double weighted_quantile(const Eigen::Ref<const Eigen::VectorXd>& values,
                         const Eigen::Ref<const Eigen::VectorXd>& weights, double probability);

}  // namespace mottle::updating
