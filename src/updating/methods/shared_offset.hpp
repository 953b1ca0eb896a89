// The given error of the model that all specimens share, as distances between samples take it.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// The error d ~ N(0, D) of outputs whose slope in the parameters' means is J, in two parts.
///
/// What the means of the tests tell of it is taken off them, since a cloud can come nearer to displaced tests by
/// growing wider alone:
///
///   z_s - E[d | r],   E[d | r] = D B (B' M B)^-1 B' r,   r = mean of the tests - mean of the cloud,   M = C / n + D
///
/// with B the directions of the outputs that no parameter moves and C the cloud's covariance. What is left of it moves
/// the mean of the population by L (d - E[d | r]), L = (J' M^-1 J)^-1 J' M^-1, and displaces tests by the rest,
/// (I - J L) (d - E[d | r]). J and C are those of one cloud: the error is small against what f is curved over.
class SharedOffset {
 public:
  /// No error.
  SharedOffset() = default;
  /// @param slopes  J, in units of the prior's standard deviations [output x parameter]
  /// @param cloud   with noise [sample x output]
  SharedOffset(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& slopes,
               const Eigen::Ref<const Eigen::MatrixXd>& cloud);

  bool is_none() const { return std_.size() == 0; }

  /// Tests as distances are to see them; missing entries stay missing [specimen x output].
  Eigen::MatrixXd taken_off(const Eigen::MatrixXd& tests) const;
  /// Simulated tests without error, displaced as measured ones are after that.
  ///
  /// @param normal  of the error, standard normal [output]
  Eigen::MatrixXd displaced(const Eigen::MatrixXd& tests, const Eigen::Ref<const Eigen::VectorXd>& normal) const;
  /// F F' is the covariance of the displacement of the mean, L cov(d | r) L' [parameter x parameter].
  const Eigen::MatrixXd& mean_factor() const { return mean_factor_; }

 private:
  Eigen::RowVectorXd residual(const Eigen::MatrixXd& tests) const;

  Eigen::VectorXd std_;           // of d [output]
  Eigen::RowVectorXd reference_;  // mean of the cloud
  Eigen::MatrixXd gain_;          // E[d | r] = gain r [output x output]
  Eigen::MatrixXd rest_;          // I - J L [output x output]
  Eigen::MatrixXd mean_factor_;
};

}  // namespace mottle::updating
