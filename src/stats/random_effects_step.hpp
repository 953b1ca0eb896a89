// One pass over all units at given Sigma and noise factors: what estimation and information have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/stats/random_effects.hpp"

namespace mottle {

inline bool may_be_correlated(const RandomEffectsSettings& settings, Eigen::Index i, Eigen::Index j) {
  const std::vector<int>& groups = settings.covariance_groups;
  return groups.empty() || groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)];
}

struct RandomEffectsPass {
  struct Unit {
    Eigen::VectorXd noise;      ///< with its factors
    Eigen::MatrixXd weighted;   ///< G' C^-1 [effect x row]
    Eigen::MatrixXd precision;  ///< C^-1 [row x row]
    Eigen::MatrixXd seen;       ///< H = G' C^-1 G [effect x effect]
  };
  std::vector<Unit> units;
  Eigen::VectorXd mean;           ///< mu
  Eigen::MatrixXd mean_variance;  ///< A^-1, in the directions that are estimated
  double log_likelihood = 0.0;

  RandomEffectsPass(const std::vector<RandomEffectsUnit>& observed, const Eigen::MatrixXd& covariance,
                    const Eigen::VectorXd& factors, const RandomEffectsSettings& settings);
};

}  // namespace mottle
