// A normal population and the levels of the noise as one vector of unbounded numbers, for searches and for sampling.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// A population on the parameters' scales, t = mean + factor u with u ~ N(0, I), and the noise of a test.
struct SampledPopulation {
  Eigen::VectorXd mean;       ///< [parameter]
  Eigen::MatrixXd factor;     ///< lower triangular, covariance = factor factor' [parameter x parameter]
  Eigen::VectorXd noise_std;  ///< [output]

  Eigen::MatrixXd covariance() const { return factor * factor.transpose(); }
};

/// Coordinates of populations:
///
///   (mean_i - t0_i) / s_i;   ln(sd_i / s_i);   Fisher's z of partial correlations;   ln of each level of the noise
///
/// t0, s the prior's mean and standard deviations on the scales. The partial correlation of i and j < i is that given
/// 0 ... j - 1, so that any numbers make a covariance [Lewandowski2009]. Pairs of different groups have none.
class PopulationCoordinates {
 public:
  /// @param noise             its levels multiply the standard deviations of `noise.base`
  /// @param has_correlations  else all are zero
  PopulationCoordinates(const UpdatingProblem& problem, const ScaledParameters& parameters, NoiseModel noise,
                        bool has_correlations);

  Eigen::Index count() const { return start_.size(); }
  Eigen::Index parameters() const { return prior_mean_.size(); }
  Eigen::Index correlations() const { return static_cast<Eigen::Index>(pairs_.size()); }
  Eigen::Index levels() const { return noise_.factors; }
  /// Unit of means and standard deviations: the prior's [parameter].
  const Eigen::VectorXd& prior_deviations() const { return prior_std_; }
  /// Place of the standard deviation of a parameter.
  Eigen::Index deviation(Eigen::Index parameter) const { return parameters() + parameter; }

  /// Fisher's z of the partial correlations [pair].
  Eigen::VectorXd fisher_z(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const {
    return coordinates.segment(2 * parameters(), correlations());
  }

  /// The prior, uncorrelated, its mean within bounds [coordinate].
  const Eigen::VectorXd& start() const { return start_; }
  /// What is allowed: means within bounds and physical limits, standard deviations from 1e-3 to 30 of the prior's,
  /// partial correlations up to 0.99, levels of noise from 1e-4 to 30.
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  /// Widths beyond which nothing needs to be known: 30 prior standard deviations of a mean, 3 of ln sd and of ln
  /// levels, 2 of Fisher's z [coordinate].
  Eigen::VectorXd widths() const;
  bool is_allowed(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const {
    return (coordinates.array() >= lower_.array()).all() && (coordinates.array() <= upper_.array()).all();
  }

  SampledPopulation at(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const;
  /// Standard deviations of the parameters [parameter].
  Eigen::VectorXd standard_deviations(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const;

 private:
  struct Pair {
    Eigen::Index row;
    Eigen::Index column;
  };

  NoiseModel noise_;
  Eigen::VectorXd prior_mean_;
  Eigen::VectorXd prior_std_;
  std::vector<Pair> pairs_;  // row by row
  Eigen::VectorXd start_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
};

}  // namespace mottle::updating
