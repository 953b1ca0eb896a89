// The statistic of the verdict's test `mean-residuals`: what the specimens' own best parameters leave of their tests,
// in the directions that no parameter moves, about its mean and of its mean.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::updating {

/// Residuals in units of the noise. With the projections P_s of the specimens onto what their parameters do not reach,
/// and v = U' N^-1/2 sum_s r_s, U the directions and N the specimens that have each output:
///
///   cov v = K = U' N^-1/2 (sum_s P_s) N^-1/2 U,   v' K^-1 v ~ chi2(rank K)
///
/// exactly where outputs are linear and the noise is that given, with entries missing and designs that differ too; it
/// is the projection of all residuals on those that a common shift makes, so that the rest of their squares is
/// independent. An error d of the model that all specimens share, d ~ N(0, D), moves them by P_s N^-1/2 d: apart, where
/// the specimens' unmoved directions differ. The squares of all are then r' (I + X D X')^-1 r, X = P N^-1/2.
struct MeanResiduals {
  Eigen::MatrixXd values;       ///< residuals, 0 where missing [specimen x output]
  Eigen::MatrixXd mean_design;  ///< in units of the noise, over the specimens that have the output [output x effect]
  Eigen::MatrixXd directions;   ///< U, orthonormal [output x direction]
  double mean_degrees_of_freedom = 0.0;  ///< rank of K
  double mean_squares = 0.0;             ///< v' (K + M D M')^-1 v, M D M' what the model's error D adds to K
  double squares = 0.0;                  ///< of the rest, given the mean
  double degrees_of_freedom = 0.0;       ///< of `squares`
  double largest_variance = 1.0;         ///< of a direction's mean against K: what the model's error makes of it
  /// Where the model has an error: noncentrality of a mean that is off by 1 in an output [output]
  Eigen::VectorXd own_noncentrality = {};
  Eigen::VectorXd shared = {};  ///< where the model has an error: E[d | residuals] [output]
};

/// @param values  the tests; only which are nan counts [specimen x output]
/// @param units   the linear problem of their specimens, of one design each
/// @param noise   variance of each output, > 0
/// @param error   standard deviation of the model's error, which all share; empty: none [output]
MeanResiduals mean_residuals(const Eigen::Ref<const Eigen::MatrixXd>& values,
                             const std::vector<RandomEffectsUnit>& units, const Eigen::VectorXd& noise,
                             const Eigen::VectorXd& error = {});

}  // namespace mottle::updating
