// What is known of a population before its tests: standard normal scores to mean, covariance, noise and model error.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/hierarchical.hpp"
#include "updating/methods/common_likelihood.hpp"

namespace mottle::updating {

/// A population on the parameters' scales, with what its tests have beside it.
struct PopulationAt {
  Eigen::VectorXd mean;         ///< mu [parameter]
  Eigen::MatrixXd factor;       ///< lower triangular F, Sigma = F F' [parameter x parameter]
  Eigen::VectorXd levels;       ///< of the noise
  Eigen::VectorXd noise;        ///< variances [output]
  Eigen::VectorXd model_error;  ///< d [output]
};

/// The prior, as a map from independent standard normal scores: of mu by the study's prior of the parameters (read as
/// that of to_variable(mu), which is the population's median), then of standard deviations, correlations, levels of the
/// noise, and the model's error where it is given.
///
///   S_i = a_i |t_nu|, a_i = scatter_scale times the prior's standard deviation on the scale
///   R by partial correlations of each pair, z / sqrt(2 alpha + z^2) with z of Student's law with 2 alpha degrees of
///     freedom, alpha = eta + (q - 2 - j) / 2 given the first j of q parameters: LKJ with shape eta
///   or Sigma of each group inverse Wishart with nu + q - 1 degrees of freedom and scale diag(nu a_i^2), so that each
///     Sigma_ii is scaled inverse chi-squared with nu degrees of freedom
///
/// What it is made of must outlive it.
/// Source: [Lewandowski2009] for R.
class PopulationPrior {
 public:
  PopulationPrior(const UpdatingProblem& problem, const HierarchicalOptions& options, const NoiseLevels& noise);

  Eigen::Index dimension() const;
  /// a_i [parameter].
  const Eigen::VectorXd& scatter_scale() const { return scale_; }
  /// What each standard deviation stays below with `probability` in (0, 1) [parameter].
  Eigen::VectorXd standard_deviations(double probability) const;
  /// Whether each point's mean lies within bounds and physical limits [point x dimension].
  std::vector<bool> is_possible(const Eigen::MatrixXd& points) const;
  /// That the levels of the noise stay above zero (NoiseLevels). @throws InvalidInput
  void require_levels(const Eigen::MatrixXd& points) const;
  /// The population of each point.
  std::vector<PopulationAt> populations(const Eigen::Ref<const Eigen::MatrixXd>& points) const;

  /// "mu:k1", "sigma:k1", "rho:k1:k2" (of pairs that may be correlated), levels of the noise, "error:f1".
  std::vector<std::string> names() const;
  /// The numbers of those names.
  Eigen::VectorXd values(const PopulationAt& population) const;

 private:
  Eigen::MatrixXd scatter_factor(const Eigen::Ref<const Eigen::VectorXd>& scores) const;
  Eigen::MatrixXd lkj_factor(const std::vector<Eigen::Index>& group, const double*& correlation) const;
  double standard_deviation(Eigen::Index parameter, double score) const;
  Eigen::Index pairs() const;

  const UpdatingProblem& problem_;
  HierarchicalOptions options_;
  const NoiseLevels& noise_;
  Eigen::VectorXd scale_;
  std::vector<std::vector<Eigen::Index>> groups_;  // parameters that may be correlated, ascending
  std::vector<Eigen::Index> with_error_;           // outputs
};

}  // namespace mottle::updating
