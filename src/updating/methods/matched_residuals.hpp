// What the moments of tests differ by from those of a cloud, in the directions that no parameter moves.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/measured_outputs.hpp"

namespace mottle::updating {

/// Directions of the outputs that no parameter moves: B with B' G = 0 [output x direction].
///
/// @param output_scale     typical size of a difference in each output, > 0
/// @param parameter_scale  the same of the parameters
/// Singular values below 1e-6 of the largest count as zero.
Eigen::MatrixXd unmoved_directions(const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                                   const Eigen::Ref<const Eigen::VectorXd>& output_scale,
                                   const Eigen::Ref<const Eigen::VectorXd>& parameter_scale);

/// Differences between tests and a cloud.
struct MatchedResiduals {
  TestMoments tests;
  Eigen::VectorXd residual;    ///< r, mean of the tests less that of the cloud [output]
  Eigen::MatrixXd of_test;     ///< covariance of one test as the cloud has it, with noise [output x output]
  Eigen::MatrixXd directions;  ///< B, unit: that of a difference in each output [output x direction]

  /// @param sensitivity      dy/dt at the cloud's mean [output x parameter]
  /// @param parameter_scale  typical size of a difference in each parameter
  static MatchedResiduals between(TestMoments tests, const Eigen::Ref<const Eigen::VectorXd>& cloud_mean,
                                  Eigen::MatrixXd of_test, const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                                  const Eigen::Ref<const Eigen::VectorXd>& parameter_scale);

  /// r' B (B' M B)^-1 B' r; negative where M is singular in a direction.
  double mean_squares(const Eigen::Ref<const Eigen::MatrixXd>& covariance) const;
};

}  // namespace mottle::updating
