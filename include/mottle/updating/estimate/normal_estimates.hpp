// Estimates that are normal distributions: a population on the parameters' scales, and moments alone.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/distributions/transformed_moments.hpp"
#include "mottle/stats/population/population_intervals.hpp"
#include "mottle/updating/estimate/estimate.hpp"

namespace mottle::updating {

/// The estimated population on the parameters' scales t, where it is normal: t ~ N(mean, covariance).
struct PopulationOnScales {
  Eigen::VectorXd mean;         ///< [parameter]
  Eigen::MatrixXd covariance;   ///< positive semi-definite [parameter x parameter]
  PopulationEvidence evidence;  ///< what the specimens show of it, on the same scales

  TransformedMoments moments(Eigen::Index parameter) const;
};

/// A variable that is normal on its scale.
struct TransformedNormal {
  ParameterTransform transform;
  TransformedMoments moments;

  /// Whether it has a density.
  bool has_width() const;
};

/// Two of them.
struct TransformedPair {
  TransformedNormal first;
  TransformedNormal second;
};

/// Outline of the region about their mean, `reach` deviations from it [point x 2].
Eigen::MatrixXd pair_outline(const TransformedPair& pair, double correlation, double reach, Eigen::Index points);

/// Deviations from the mean within which a bivariate normal lies with `probability`: sqrt(-2 ln(1 - probability)).
double reach_of_pair(double probability);

/// An estimate whose marginals are normal on scales.
class NormalEstimate : public Estimate {
 public:
  Eigen::VectorXd mean() const final { return distribution_.mean(); }
  Eigen::MatrixXd covariance() const final { return distribution_.covariance(); }
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const final;
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const final;
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const final;
  double quantile(Eigen::Index parameter, double probability) const final;

 protected:
  /// @param distribution  moments and draws are its
  /// @param marginals     densities and quantiles are theirs [parameter]
  NormalEstimate(JointDistribution distribution, std::vector<TransformedNormal> marginals);

  const TransformedNormal& marginal(Eigen::Index parameter) const {
    return marginals_[static_cast<std::size_t>(parameter)];
  }

 private:
  JointDistribution distribution_;
  std::vector<TransformedNormal> marginals_;
};

/// A population of specimens that is normal on the parameters' scales.
class NormalPopulation final : public NormalEstimate {
 public:
  /// @param scales      one a parameter
  /// @param population  its evidence may be empty where `specimens` is 0
  /// @param specimens   that it was estimated from; 0: known exactly
  /// @throws InvalidInput  as JointDistribution::transformed_normal
  NormalPopulation(std::vector<ParameterTransform> scales, PopulationOnScales population, Eigen::Index specimens);

  EstimateKind kind() const override { return EstimateKind::population; }
  Eigen::VectorXd location() const override;
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override;
  Eigen::MatrixXd correlation() const override;

  /// With total T = Sigma + N, noise's share N, covariance M of the mean and degrees of freedom nu_i of T_ii: the
  /// equations of predict().
  Eigen::MatrixXd draw_specimens(const SpecimenDrawing& drawing) const override;
  Eigen::Index specimens() const override { return specimens_; }
  bool has_joint_region() const override;
  std::string prediction_note() const override;
  const PopulationOnScales* population() const override { return &population_; }

 private:
  std::vector<ParameterTransform> scales_;
  PopulationOnScales population_;
  Eigen::Index specimens_ = 0;
};

/// Mean and covariance on the parameters' own axes, of methods that find no more. Draws are of the normal distribution
/// of these moments, as the methods' own equations have it, and so are regions of pairs. Marginal densities and
/// quantiles are those of the variables with these moments that are normal on the parameters' scales, so that a
/// positive parameter has no density below zero; where there are none, those of the normal distribution.
class MomentEstimate final : public NormalEstimate {
 public:
  /// @throws InvalidInput  as JointDistribution::multivariate_normal
  MomentEstimate(const std::vector<ParameterTransform>& scales, const Eigen::VectorXd& mean,
                 const Eigen::MatrixXd& covariance);

  EstimateKind kind() const override { return EstimateKind::mean; }
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override;
  Eigen::MatrixXd draw_specimens(const SpecimenDrawing& drawing) const override;
  std::string prediction_note() const override;
};

}  // namespace mottle::updating
