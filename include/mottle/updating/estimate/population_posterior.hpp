// The posterior of a normal population: what is shown of it is one population amid the draws, what is predicted comes
// from all of them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"

namespace mottle::updating {

/// Draws of a population on the parameters' scales.
struct PopulationDraws {
  Eigen::MatrixXd means;                      ///< mu [draw x parameter]
  std::vector<Eigen::MatrixXd> factors = {};  ///< F, Sigma = F F' [parameter x parameter], one a draw
  /// The part of each mean that follows the model's error; empty: none [draw x parameter].
  Eigen::MatrixXd shifts = {};
};

/// A population of specimens that is known as far as draws of it agree.
///
/// Moments, densities, quantiles and regions are those of `typical`. draw_specimens() draws of the posterior predictive
/// distribution, x ~ N(mu_i, Sigma_i) with a draw i of the posterior each.
class PopulationPosterior final : public Estimate {
 public:
  /// @param typical  the population that stands for the draws
  /// @throws InvalidInput  as NormalPopulation, no draws, or not one factor for each mean
  PopulationPosterior(std::vector<ParameterTransform> scales, PopulationOnScales typical, PopulationDraws draws,
                      double log_evidence);

  EstimateKind kind() const override { return EstimateKind::population; }
  Eigen::VectorXd mean() const override { return typical_.mean(); }
  Eigen::MatrixXd covariance() const override { return typical_.covariance(); }
  Eigen::VectorXd location() const override { return typical_.location(); }
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const override {
    return typical_.from_uniform(uniforms);
  }
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const override {
    return typical_.density(parameter, points);
  }
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const override {
    return typical_.density_points(parameter, count);
  }
  double quantile(Eigen::Index parameter, double probability) const override {
    return typical_.quantile(parameter, probability);
  }
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override {
    return typical_.region(first, second, probability, points);
  }
  Eigen::MatrixXd correlation() const override { return typical_.correlation(); }
  Eigen::MatrixXd draw_specimens(const SpecimenDrawing& drawing) const override;
  const PopulationOnScales* population() const override { return typical_.population(); }
  std::optional<double> log_evidence() const override { return log_evidence_; }

 private:
  std::vector<ParameterTransform> scales_;
  NormalPopulation typical_;
  PopulationDraws draws_;
  double log_evidence_;
};

}  // namespace mottle::updating
