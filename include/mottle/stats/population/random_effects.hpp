// Linear random effects: every unit (specimen) has its own effects, drawn from one normal population, and is observed
// with noise. Estimates the population; for confidence intervals see population_intervals.hpp.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// What was observed of one unit: y = G x + E d + e, x ~ N(mu, Sigma), e ~ N(0, diag(noise)), d ~ N(0, D) the same for
/// all units. Missing entries have no row.
struct RandomEffectsUnit {
  Eigen::MatrixXd design;        ///< G [row x effect]
  Eigen::VectorXd response;      ///< y [row]
  Eigen::VectorXd noise;         ///< variance of e; to be multiplied by a factor where that is estimated [row]
  std::vector<int> factor = {};  ///< of each row: index of the factor on its noise, -1: known. Empty: all known
  Eigen::MatrixXd shared = {};   ///< E [row x shared]; empty: no error is shared
};

/// Variances of a unit's noise with their factors [row].
Eigen::VectorXd noise_of(const RandomEffectsUnit& unit, const Eigen::VectorXd& factors);

struct RandomEffectsSettings {
  bool is_restricted = true;                ///< REML: unbiased in small samples; false: maximum likelihood
  int factors = 0;                          ///< number of noise factors to estimate
  std::vector<int> covariance_groups = {};  ///< effects of different groups are not correlated; empty: one group
  /// The mean is mean_origin + mean_directions m, m estimated [effect], [effect x m]; empty: every mean is estimated.
  Eigen::VectorXd mean_origin = {};
  Eigen::MatrixXd mean_directions = {};
  /// Weight, in units, of a prior towards uncorrelated effects. Where entries are missing the likelihood may
  /// have no maximum without it (three complete units of three effects lie in a plane).
  double shrinkage = 0.0;
  /// Errors d that all units share: variance, to be multiplied by a level where `shared_level` is not -1 [shared].
  Eigen::VectorXd shared_variance = {};
  std::vector<int> shared_level = {};  ///< index of the level on each variance, -1: known; empty: all known [shared]
  int levels = 0;                      ///< number of levels to estimate
  int iterations = 2000;
  double tolerance = 1e-8;  ///< of the largest change of Sigma in one step, relative to its standard deviations
};

/// An estimate of the population.
struct RandomEffectsFit {
  Eigen::VectorXd mean;           ///< mu [effect]
  Eigen::MatrixXd covariance;     ///< Sigma, positive semi-definite [effect x effect]
  Eigen::VectorXd noise_factors;  ///< [factor]
  Eigen::MatrixXd effects;        ///< E[x | y] of every unit [unit x effect]
  Eigen::VectorXd shared;         ///< E[d | y] [shared]
  Eigen::VectorXd levels;         ///< of the variances of d [level]
  double log_likelihood = 0.0;    ///< at the estimate, restricted where the settings say so; constants left out
  int iterations = 0;
  bool converged = false;
};

/// Sampling covariances of an estimate.
struct RandomEffectsInformation {
  Eigen::MatrixXd mean_from_effects;  ///< covariance of the estimated mean: the part due to the effects' scatter
  Eigen::MatrixXd mean_from_noise;    ///< and the part due to the noise; without shared errors their sum is A^-1
  std::vector<std::pair<Eigen::Index, Eigen::Index>> entries;  ///< the free entries of Sigma, lower triangle
  Eigen::MatrixXd entry_covariance;                            ///< their sampling covariance [entry x entry]

  /// Sampling variance of a' Sigma b.
  double variance_of(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) const;
};

/// The sum of squares from which a variance level of shared errors is estimated: (known + level) chi-squared, exactly
/// where the designs of all units are equal, else in its first two moments.
struct SharedErrorLevel {
  double observed = 0.0;            ///< estimate of known + level, its mean square
  double known = 0.0;               ///< contribution of the noise
  double degrees_of_freedom = 0.0;  ///< 0: the units do not determine the level
};

/// Shared errors at a fit, and their effect on the estimated mean.
struct SharedErrorInformation {
  Eigen::MatrixXd covariance;   ///< of d given the data, of the mixed-model equations [shared x shared]
  Eigen::MatrixXd gain;         ///< change of the mean with d subtracted from the data [effect x shared]
  Eigen::MatrixXd sensitivity;  ///< change of the estimated mean with d in the data [effect x shared]
  std::vector<SharedErrorLevel> levels;
};

/// Restricted or plain maximum likelihood by expectation-maximisation with squared extrapolation.
///
///   C_s = G_s Sigma G_s' + R_s,   mu = A^-1 sum G_s' C_s^-1 y_s,   A = sum G_s' C_s^-1 G_s
///   Sigma <- mean over s of [ b_s b_s' + Sigma - Sigma G_s' P_ss G_s Sigma ],  b_s = Sigma G_s' C_s^-1 (y_s - G_s mu)
///   P_ss = C_s^-1 - C_s^-1 G_s A^-1 G_s' C_s^-1 (restricted),  C_s^-1 (plain)
///
/// A noise factor is the mean over its rows of [ e^2 + R - R P R ] / noise, e = R C^-1 (y - G mu). Entries of Sigma
/// between groups are zero. Directions that no unit sees keep the covariance of the start.
///
/// With shared errors the mixed-model equations take the place of those of the mean, X_s = [G_s, E_s]:
///
///   [mu; d] = M sum X_s' C_s^-1 y_s,   M = (sum X_s' C_s^-1 X_s + blockdiag(0, D^-1))^-1,
///   P_ss = C_s^-1 - C_s^-1 X_s M X_s' C_s^-1 (restricted; plain: only the part of d in M),  y_s - G_s mu - E_s d in
///   b_s
///
/// so that mu is the generalised least-squares estimate of all units together, whose covariance is blockdiag(C_s) +
/// E D E'. Estimated levels of D: Fisher's scoring on the same likelihood.
///
/// @param units  at least 2; together they must see every direction in which the mean is estimated
/// @param start  Sigma to start from, positive definite but for effects of variance 0: those keep it, all units share
///               one value of them
/// @throws InvalidInput  fewer than 2 units, shapes that do not fit, a mean that the units do not determine
/// Source: [Laird1982]; [Varadhan2008] for the extrapolation; [Chung2015] for weak beliefs on a covariance;
/// [Henderson1975] for the mixed-model equations; [Harville1977] for scoring.
RandomEffectsFit fit_random_effects(const std::vector<RandomEffectsUnit>& units,
                                    const Eigen::Ref<const Eigen::MatrixXd>& start,
                                    const RandomEffectsSettings& settings);

/// Fisher's expected information at a fit, and the parts of the mean's covariance.
///
///   I_jk = 1/2 tr(P E_j P E_k) over the free entries of Sigma; its inverse is `entry_covariance`
RandomEffectsInformation random_effects_information(const std::vector<RandomEffectsUnit>& units,
                                                    const RandomEffectsFit& fit, const RandomEffectsSettings& settings);

/// The covariance of the estimated mean is that without shared errors and gain * covariance * gain'; the latter holds
/// no estimate of Sigma where all units are alike. Of an estimated level, from y' P E P y, tr(P E) and tr(P E P E):
///
///   degrees of freedom nu = tr(P E)^2 / tr(P E P E),   known + level = tr(P E) / tr(P E P E)
///
/// less what other levels take of its information.
/// Source: [Henderson1975]; [Satterthwaite1946].
SharedErrorInformation shared_error_information(const std::vector<RandomEffectsUnit>& units,
                                                const RandomEffectsFit& fit, const RandomEffectsSettings& settings);

}  // namespace mottle::stats
