// A population of several batches, each normal on the parameters' scales, and what a method finds of its batches.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"
#include "mottle/stats/distributions/transformed_moments.hpp"
#include "mottle/stats/population/mixture_choice.hpp"
#include "mottle/updating/estimate/estimate.hpp"

namespace mottle::updating {

/// One batch on the parameters' scales.
struct BatchOnScales {
  double weight = 1.0;         ///< of the specimens that are no outliers, > 0
  Eigen::VectorXd mean;        ///< [parameter]
  Eigen::MatrixXd covariance;  ///< positive semi-definite [parameter x parameter]
};

/// p(t) = sum_k w_k N(t; mu_k, Sigma_k), t the parameters on their scales.
///
/// Regions of pairs are ellipses about the batches, which may overlap: what is in any of them. All have one reach in
/// standard deviations, so that together they hold the region's probability.
class MixturePopulation final : public Estimate {
 public:
  /// @param scales   one a parameter
  /// @param batches  at least one; their weights have the sum 1
  MixturePopulation(std::vector<ParameterTransform> scales, std::vector<BatchOnScales> batches);

  EstimateKind kind() const override { return EstimateKind::population; }
  Eigen::VectorXd mean() const override { return mean_; }
  Eigen::MatrixXd covariance() const override { return covariance_; }
  /// The first uniform of a row also chooses the batch.
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const override;
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const override;
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const override;
  double quantile(Eigen::Index parameter, double probability) const override;
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override;
  std::string prediction_note() const override;

  const std::vector<BatchOnScales>& batches() const { return batches_; }

 private:
  TransformedMoments moments(const BatchOnScales& batch, Eigen::Index parameter) const;

  std::vector<ParameterTransform> scales_;
  std::vector<BatchOnScales> batches_;
  std::vector<JointDistribution> distributions_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
};

/// One batch, on the parameters' own axes.
struct Batch {
  double weight = 1.0;
  Eigen::VectorXd mean = {};           ///< [parameter]
  Eigen::VectorXd std = {};            ///< [parameter]
  Eigen::MatrixXd correlation = {};    ///< on the scales; nan: no scatter [parameter x parameter]
  Eigen::MatrixXd mean_interval = {};  ///< 95 % [parameter x 2]
  Eigen::MatrixXd std_interval = {};
  Eigen::Index specimens = 0;  ///< that are most probably of it
};

/// Batches and to which of them each specimen belongs.
struct MixtureFindings {
  std::vector<Batch> batches;             ///< the heaviest first
  Eigen::MatrixXd probabilities;          ///< of each specimen's batch; the last column: outlier [specimen x batch + 1]
  bool is_number_given = false;           ///< the number of batches was not tested
  std::vector<ComponentsTest> tests;      ///< of the number of batches
  std::optional<double> detectable = {};  ///< distance of two batches, in standard deviations, found with 80 %

  /// Most probable batch of a specimen; -1: an outlier.
  Eigen::Index batch_of(Eigen::Index specimen) const;
};

/// More probable than not.
inline constexpr double k_outlying = 0.5;

}  // namespace mottle::updating
