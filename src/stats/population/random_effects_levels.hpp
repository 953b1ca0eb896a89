// Estimated levels of the variances of shared errors.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// The likelihood's slope and Fisher's information at a fit, D = sum over levels of level * E_f,
///
///   2 dl / dlevel = y' P E_f P y - tr(P E_f),   information = tr(P E_f P E_g)
///
/// Where one level stands over errors alike and r of their combinations are not moved by any parameter, the sum of
/// squares of those is (known part + level) chi-squared_r: trace^2 / information is r and trace / information is
/// known part + level.
struct LevelScores {
  Eigen::VectorXd quadratic;    ///< y' P E P y [level]
  Eigen::VectorXd trace;        ///< tr(P E) [level]
  Eigen::MatrixXd information;  ///< tr(P E_f P E_g) [level x level]
};

LevelScores level_scores(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                         const RandomEffectsSettings& settings);

/// One step of Fisher's scoring, levels kept at zero or above; a level that the units do not determine stays.
Eigen::VectorXd scored_levels(const LevelScores& scores, const Eigen::VectorXd& levels);

/// Whether the units say anything of a level.
bool is_determined(const LevelScores& scores, const Eigen::VectorXd& levels, Eigen::Index level);

}  // namespace mottle::stats
