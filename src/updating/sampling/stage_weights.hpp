// Weights of a stage of a sequential Monte Carlo sampler: how far the next exponent may go, and who is resampled.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// From one exponent of a likelihood to the next.
struct StageWeights {
  double exponent = 0.0;    ///< the next one
  Eigen::VectorXd weights;  ///< of the particles, their sum is 1
  double log_mean = 0.0;    ///< ln of the mean of L^increment: what the evidence is multiplied by
  double effective_samples = 0.0;
};

/// The largest step of the exponent, to 1 at most, whose weights L^increment leave a fraction of the living particles
/// effective, (sum w)^2 / sum w^2.
///
/// @param log_likelihood  ln L of each particle, -infinity: dead; at least one is alive
/// @param exponent        where the particles are, in [0, 1)
/// @param fraction        in (0, 1)
StageWeights next_stage(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood, double exponent, double fraction);

/// Systematic resampling: which particle each new one is a copy of, in ascending order.
///
/// @param weights  their sum is 1
/// @param shift    in (0, 1)
std::vector<Eigen::Index> systematic_parents(const Eigen::Ref<const Eigen::VectorXd>& weights, double shift);

/// Correlation with a stage's start at which its moves end: `decorrelation`, but not below 2.5 / sqrt(particles), which
/// the largest of some correlations of independent particles is by chance.
double correlation_limit(double decorrelation, int particles);

/// Correlation of two columns of numbers; 0 where one of them is constant.
double correlation_of(const Eigen::Ref<const Eigen::ArrayXd>& first, const Eigen::Ref<const Eigen::ArrayXd>& second);

}  // namespace mottle::updating
