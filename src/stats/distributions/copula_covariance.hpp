// Pearson covariance of variables that are functions of correlated standard normals.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/distribution.hpp"

namespace mottle::stats {

/// Covariance of X_j = F_j^-1(Phi(w_j)), w ~ N(0, copula_correlation); see JointDistribution::covariance.
Eigen::MatrixXd copula_covariance(const std::vector<Distribution>& marginals,
                                  const Eigen::MatrixXd& copula_correlation);

}  // namespace mottle::stats
