// Confidence intervals of a population's means, standard deviations and correlations.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// Estimates from which intervals follow. `total` = Sigma + noise has the sampling distribution of a sample covariance
/// with `degrees_of_freedom`.
struct PopulationEvidence {
  Eigen::VectorXd mean;                ///< [variable]
  Eigen::MatrixXd total;               ///< [variable x variable]
  Eigen::MatrixXd noise;               ///< the part of `total` due to measurement noise [variable x variable]
  Eigen::MatrixXd mean_covariance;     ///< of `mean` [variable x variable]
  Eigen::MatrixXd degrees_of_freedom;  ///< of each entry of `total`; 0: not determined [variable x variable]
  /// The part of `mean_covariance` due to errors shared by all units: it does not shrink with their number. Empty: none
  /// [variable x variable].
  Eigen::MatrixXd mean_shared = {};
  /// The part of `mean_shared` due to each estimated variance level, at level one, and the level's own estimate.
  std::vector<std::pair<Eigen::MatrixXd, SharedErrorLevel>> levels = {};
};

/// Evidence from a fit.
///
/// Where every unit determines its own effects, none much worse than the others, `total` is the sample covariance of
/// the generalised least-squares estimates of the units (exactly Wishart distributed, n - 1 degrees of freedom). Else
/// `total` is Sigma plus the noise's share of n var(mu), and its degrees of freedom come from the expected information,
/// nu = 2 total^2 / var, less what small samples with missing entries take away: nu (n / (n + 3)).
/// Source: [Satterthwaite1946]; [Barnard1999] for the last.
///
/// @param map  variables are x = map t of the effects t [variable x effect]
PopulationEvidence population_evidence(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                                       const RandomEffectsSettings& settings,
                                       const Eigen::Ref<const Eigen::MatrixXd>& map);

/// Ends of intervals; nan where the units do not determine them.
struct PopulationIntervals {
  Eigen::MatrixXd mean;               ///< [variable x 2]
  Eigen::MatrixXd std;                ///< [variable x 2]
  Eigen::MatrixXd correlation_lower;  ///< [variable x variable]
  Eigen::MatrixXd correlation_upper;  ///< [variable x variable]
};

/// Two-sided intervals on the variables' own axes.
///
/// Mean: Student's t; with shared errors of known variance the degrees of freedom of the sum of both variances, nu
/// (v / (v - v_shared))^2 [Satterthwaite1946]; with estimated levels the fiducial distribution of the mean, over those
/// of its scatter and of each level, max(0, nu_level observed / chi2 - known). Standard deviation: sqrt(nu total / chi2
/// - noise), zero where that is negative. Correlation: quantiles of the fiducial distribution from the Bartlett
/// decomposition of a 2 x 2 covariance, less the noise, over its draws with positive variances. All three are exact for
/// a normal sample without noise. Means and standard deviations of variables with a log or logit transform: quantiles
/// over the joint fiducial draws of mean and variance of the transformed variable. Correlations are those of the
/// transformed variables.
///
/// @param transforms  one a variable
/// @param confidence  in (0, 1)
/// Source: [Anderson2003], ch. 3 and 4; [Krishnamoorthy2003] for the lognormal mean.
PopulationIntervals population_intervals(const PopulationEvidence& evidence,
                                         const std::vector<ParameterTransform>& transforms, double confidence);

}  // namespace mottle::stats
