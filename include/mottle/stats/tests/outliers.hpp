// Outlier tests for the specimens of a normal population.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// An outlying specimen.
struct Outlier {
  Eigen::Index sample = 0;
  double distance = 0.0;  ///< Mahalanobis distance from the specimens that are no outliers, its own covariance added
  double p_value = 1.0;   ///< probability of evidence at least as large without outliers, at any number of suspects
};

/// Outliers of a normal sample, also where several mask one another.
///
/// For each number k of suspects, up to a third of the sample and ten, in all variables together and in each alone, a
/// forward search finds the core of n - k with the least scatter, and the nearest suspect's distance from it,
///
///   m / (m + 1) D^2 ~ Hotelling's T^2 with m - 1 degrees of freedom, m = n - k,
///
/// gives the evidence t = ln(-ln P). With mean and standard deviation s of each t in samples without outliers, the
/// largest (t - mean) / s is compared with its own distribution there, both from up to 999 simulated samples with fixed
/// streams. Where it is larger than all but `level` of them, the k suspects of the maximum are outliers; the rest is
/// tested again as a sample of its own.
///
/// @param samples  [specimen x variable], no nan; at least 4 specimens to test one variable, q + 3 to test all together
/// @param level    probability that a sample without outliers is said to have one
/// @return         the farthest first
/// Source: [Wilks1963]; [Caroni1992]; [Riani2009] for the search.
std::vector<Outlier> find_outliers(const Eigen::Ref<const Eigen::MatrixXd>& samples, double level);

/// The same for specimens that are observed with noise or in part: each distance has the specimen's own covariance
/// G_s Sigma G_s' + R_s, in the directions that its effects move, and the simulated samples have the same missing
/// entries and noise (fixed streams). Where the specimens' own estimates have about the same covariance, they are
/// tested as a complete sample, as above.
///
/// @param fit, settings  population of all units
/// @param map            variables of effects [variable x effect]
std::vector<Outlier> find_outliers(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                                   const RandomEffectsSettings& settings, const Eigen::Ref<const Eigen::MatrixXd>& map,
                                   double level);

}  // namespace mottle::stats
