// Each specimen's own information on its effects, in whitened coordinates of the population: the directions with
// variance, each scaled to variance 1.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// What was observed of one specimen's effects x ~ N(0, 1): y = A x + e, e ~ N(0, noise).
struct EffectEvidence {
  Eigen::MatrixXd design;    ///< A [row x direction]
  Eigen::MatrixXd noise;     ///< [row x row]
  Eigen::VectorXd response;  ///< y [row]
};

/// Sigma = root root' over the directions that scatter, inverse root = 1.
struct ScatterRoot {
  Eigen::MatrixXd root;     ///< [effect x direction]
  Eigen::MatrixXd inverse;  ///< [direction x effect]
};
ScatterRoot scatter_root(const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// Specimens in whitened effects x: effects = mean + root x.
struct WhitenedEffects {
  Eigen::MatrixXd root;  ///< [effect x direction]
  std::vector<EffectEvidence> specimens;
};

/// The rows of every unit, rotated to those that depend on effects, no more than there are directions.
WhitenedEffects whiten_effects(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit);

/// E[x | y] of every specimen of a population N(mean, covariance) and how it scatters.
struct ShrunkenEffects {
  Eigen::MatrixXd points;                ///< less the mean [specimen x direction]
  std::vector<Eigen::MatrixXd> spreads;  ///< covariance of a point = spread spread' [direction x row]

  /// a'x for each axis a, a row of `axes` [specimen x axis].
  Eigen::MatrixXd along(const Eigen::Ref<const Eigen::MatrixXd>& axes) const;
  /// Standard deviation of each estimate relative to the population's: 1 where x is known exactly, 0 where not at all
  /// [specimen x axis].
  Eigen::MatrixXd standard_deviations(const Eigen::Ref<const Eigen::MatrixXd>& axes) const;
};
ShrunkenEffects shrink_effects(const std::vector<EffectEvidence>& specimens, const Eigen::VectorXd& mean,
                               const Eigen::MatrixXd& covariance);

/// Cholesky factor of a covariance; one that is singular to rounding is regularised.
CholeskyFactor positive_factor(Eigen::MatrixXd matrix);

/// Own least-squares estimates [specimen x direction]; nothing where a specimen does not determine its effects.
/// @param likeness  largest difference of two specimens' noise, in population variances
std::optional<Eigen::MatrixXd> alike_estimates(const WhitenedEffects& effects, double likeness);

}  // namespace mottle::stats
