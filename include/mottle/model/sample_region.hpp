// The region of the parameters in which the samples of several batches lie.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "mottle/core/checksum.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_space.hpp"

namespace mottle::model {

/// A model that answers within a tolerance may be adapted to a region: a function of the region alone, so that the
/// numbers of a batch depend on that batch and its region, and on nothing before.
class SampleRegion {
 public:
  /// @param centre   where the approximation begins [parameter]
  /// @param samples  what it learns from, of no batch [sample x parameter]
  SampleRegion(Eigen::VectorXd centre, Eigen::MatrixXd samples);

  const Eigen::VectorXd& centre() const { return centre_; }
  const Eigen::MatrixXd& samples() const { return samples_; }
  /// Of all its numbers.
  const Digest& digest() const { return digest_; }

 private:
  Eigen::VectorXd centre_;
  Eigen::MatrixXd samples_;
  Digest digest_;
};

/// The region of a distribution, by 400 samples that no cloud uses. The last 100 are 1.25 times as far out in standard
/// normal space: they stand for the rarest of a large cloud.
SampleRegion region_of(const ParameterSpace& space, const Eigen::VectorXd& centre,
                       const JointDistribution& distribution);

}  // namespace mottle::model
