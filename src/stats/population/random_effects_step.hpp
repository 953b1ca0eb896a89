// One pass over all units at given Sigma, noise factors and levels: what estimation and information have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// Smallest eigenvalue of Sigma's correlation, as a fraction of the largest: all that is computed from Sigma^-1 then
/// keeps half of the digits, while no standard deviation changes by more than a ten-thousandth of another.
inline constexpr double k_min_eigenvalue = 1e-8;

inline bool may_be_correlated(const RandomEffectsSettings& settings, Eigen::Index i, Eigen::Index j) {
  const std::vector<int>& groups = settings.covariance_groups;
  return groups.empty() || groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)];
}

/// The settings with the variances of shared errors at these levels, known from there on.
RandomEffectsSettings at_levels(const RandomEffectsSettings& settings, const Eigen::VectorXd& levels);

/// Common effects are those that all units share: the mean, and after it the shared errors.
struct RandomEffectsPass {
  struct Unit {
    Eigen::VectorXd noise;      ///< with its factors
    Eigen::MatrixXd weighted;   ///< G' C^-1 [effect x row]
    Eigen::MatrixXd precision;  ///< C^-1 [row x row]
    Eigen::MatrixXd seen;       ///< H = G' C^-1 G [effect x effect]

    /// X' C^-1 of the common effects [common x row]
    const Eigen::MatrixXd& common_weighted() const { return has_shared ? shared_weighted : weighted; }
    /// X' C^-1 G [common x effect]
    const Eigen::MatrixXd& common_seen() const { return has_shared ? shared_seen : seen; }
    /// G' C^-1 X [effect x common]
    const Eigen::MatrixXd& seen_common() const { return has_shared ? seen_shared : seen; }

    bool has_shared = false;
    Eigen::MatrixXd shared_weighted;  ///< these three of all common effects; empty where no error is shared
    Eigen::MatrixXd shared_seen;
    Eigen::MatrixXd seen_shared;
    Eigen::VectorXd residual;  ///< y - G mu - E d [row]
  };
  std::vector<Unit> units;
  Eigen::VectorXd mean;             ///< mu
  Eigen::VectorXd shared;           ///< d
  Eigen::MatrixXd information;      ///< sum of X' C^-1 X [common x common]
  Eigen::MatrixXd common_variance;  ///< M, in the directions in which the mean is estimated [common x common]
  /// What P takes away of the common effects: M of the restricted likelihood, its part of d alone of the plain one;
  /// empty: nothing [common x common].
  Eigen::MatrixXd removed_variance;
  double log_likelihood = 0.0;

  /// @param settings  without levels to estimate (see at_levels)
  RandomEffectsPass(const std::vector<RandomEffectsUnit>& observed, const Eigen::MatrixXd& covariance,
                    const Eigen::VectorXd& factors, const RandomEffectsSettings& settings);

 private:
  Unit make_unit(const RandomEffectsUnit& from, const Eigen::MatrixXd& covariance, const Eigen::VectorXd& factors);
  void solve_common(const RandomEffectsSettings& settings, const Eigen::VectorXd& gradient);
};

}  // namespace mottle::stats
