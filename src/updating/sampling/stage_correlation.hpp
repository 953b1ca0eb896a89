// How much particles still resemble those that a stage began with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// Particles at a stage's start, in terms of normal scores of their ranks: of each coordinate, of its distance from the
/// median, which sees the tails, and of the log-likelihood. Ranks are for long tails and bent ridges, where products of
/// the values themselves are those of two or three particles.
class StageStart {
 public:
  StageStart() = default;
  /// @param points          [particle x dimension], >= 2 particles
  /// @param log_likelihood  [particle]
  StageStart(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::VectorXd>& log_likelihood);

  /// Largest correlation, in absolute value, of these scores with those of the same particles now; 0 for a column
  /// that is constant.
  double correlation_with(const Eigen::Ref<const Eigen::MatrixXd>& points,
                          const Eigen::Ref<const Eigen::VectorXd>& log_likelihood) const;

 private:
  std::vector<double> scores_of_ranks_;
  Eigen::VectorXd medians_;  // [dimension]
  Eigen::MatrixXd scores_;   // of length 1, without their mean [particle x (2 dimension + 1)]
};

}  // namespace mottle::updating
