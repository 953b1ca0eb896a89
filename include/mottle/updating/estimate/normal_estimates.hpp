// Estimates that are normal distributions: a population on the parameters' scales, and moments alone.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/distributions/scale_moments.hpp"
#include "mottle/stats/population/population_intervals.hpp"
#include "mottle/updating/estimate/estimate.hpp"

namespace mottle::updating {

/// The estimated population on the parameters' scales t, where it is normal: t ~ N(mean, covariance).
struct PopulationOnScales {
  Eigen::VectorXd mean;         ///< [parameter]
  Eigen::MatrixXd covariance;   ///< positive semi-definite [parameter x parameter]
  PopulationEvidence evidence;  ///< what the specimens show of it, on the same scales
};

/// Two variables that are normal on their scales.
struct ScaledPair {
  NormalScale first;
  NormalScale second;
  ScaleMoments first_moments;
  ScaleMoments second_moments;
};

/// Outline of the region about their mean, `reach` deviations from it [point x 2].
Eigen::MatrixXd pair_outline(const ScaledPair& pair, double correlation, double reach, Eigen::Index points);

/// Deviations from the mean within which a bivariate normal lies with `probability`: sqrt(-2 ln(1 - probability)).
double reach_of_pair(double probability);

/// A population of specimens that is normal on the parameters' scales.
class NormalPopulation final : public Estimate {
 public:
  /// @param scales      one a parameter
  /// @param population  its evidence may be empty where `specimens` is 0
  /// @param specimens   that it was estimated from; 0: known exactly
  /// @throws InvalidInput  as JointDistribution::normal_on_scales
  NormalPopulation(std::vector<NormalScale> scales, PopulationOnScales population, Eigen::Index specimens);

  EstimateKind kind() const override { return EstimateKind::population; }
  Eigen::VectorXd mean() const override { return distribution_.mean(); }
  Eigen::MatrixXd covariance() const override { return distribution_.covariance(); }
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const override;
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const override;
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const override;
  double quantile(Eigen::Index parameter, double probability) const override;
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
  std::vector<NormalScale> scales_;
  PopulationOnScales population_;
  Eigen::Index specimens_ = 0;
  JointDistribution distribution_;
};

/// Mean and covariance on the parameters' own axes, of methods that find no more. Draws are of the normal distribution
/// of these moments, as the methods' own equations have it, and so are regions of pairs. Marginal densities and
/// quantiles are those of the variables with these moments that are normal on the parameters' scales, so that a
/// positive parameter has no density below zero; where there are none, those of the normal distribution.
class MomentEstimate final : public Estimate {
 public:
  /// @throws InvalidInput  as JointDistribution::multivariate_normal
  MomentEstimate(const std::vector<NormalScale>& scales, const Eigen::VectorXd& mean,
                 const Eigen::MatrixXd& covariance);

  EstimateKind kind() const override { return EstimateKind::mean; }
  Eigen::VectorXd mean() const override { return distribution_.mean(); }
  Eigen::MatrixXd covariance() const override { return distribution_.covariance(); }
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const override;
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const override;
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const override;
  double quantile(Eigen::Index parameter, double probability) const override;
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override;
  Eigen::MatrixXd draw_specimens(const SpecimenDrawing& drawing) const override;
  std::string prediction_note() const override;

 private:
  std::vector<NormalScale> scales_;    // identity where the moments have no match on the parameter's own
  std::vector<ScaleMoments> moments_;  // on them
  JointDistribution distribution_;
};

}  // namespace mottle::updating
