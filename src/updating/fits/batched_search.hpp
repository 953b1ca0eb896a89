// Least-squares searches side by side: the trials of all that still move are one batch of model runs.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// What a batch of searches asks of each and of the model.
struct BatchedSearch {
  std::function<Eigen::VectorXd(Eigen::Index search)> propose;             ///< where it tries next
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& trials)> evaluate;  ///< [trial x output], nan: the model fails
  /// Accepts or rejects the trial; returns whether the search goes on.
  std::function<bool(Eigen::Index search, const Eigen::VectorXd& trial, const Eigen::VectorXd& outputs)> judge;
};

/// One trial of each search in `moving`; those that have ended are taken out.
void try_once(const BatchedSearch& searches, std::vector<Eigen::Index>& moving);

}  // namespace mottle::updating
