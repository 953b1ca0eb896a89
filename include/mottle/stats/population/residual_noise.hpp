// Levels of the measurement noise from what the units' own effects leave of them, about means that are free.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// Which noise is to be estimated.
struct OutputLevels {
  std::vector<int> of_output;  ///< index of each output's level, -1: its noise is known [output]
  Eigen::VectorXd expected;    ///< where the iteration starts, and what the levels are believed to be [level]
  double weight = 0.0;         ///< of that belief, in observations of each output
};

/// Estimated levels of the noise.
struct ResidualNoise {
  Eigen::VectorXd levels;           ///< factor on the noise of the outputs of each level [level]
  double degrees_of_freedom = 0.0;  ///< of all residuals; 0: there are none, the levels are those expected
  bool converged = false;
};

/// Orthonormal basis of what the columns of a design reach, each by its own size: moduli and lengths differ by 1e14
/// [row x rank].
Eigen::MatrixXd reached_by(const Eigen::MatrixXd& design);

/// Restricted likelihood of the noise alone: every unit's effects x_s and the mean error b of each output are free,
///
///   y_s = G_s x_s + b + e_s,   e_s ~ N(0, R_s),   R_s = noise * level of the output,
///
/// so that neither the population of the effects nor means that the effects cannot reach change the levels. The means
/// are free in the directions of which the residuals see at least a twentieth of what they would without effects, at
/// the expected levels; what remains of the others is the change of the designs from unit to unit. With P_s = R_s^-1 -
/// R_s^-1 G_s (G_s' R_s^-1 G_s)^+ G_s' R_s^-1 and P = P_s - P_s (sum P_t)^+ P_s it repeats
///
///   level <- [ sum e^2 / noise + weight * expected ] / (sum r P_kk + weight),   e_s = R_s P_s (y_s - b),
///
/// whose rest is the most probable level under an inverse-gamma prior, whose `weight` counts as that many observations.
/// A level below 1e-16 is taken for rounding and is 1e-16. Without effects it is (n - 1) / (n - 1 + weight) of the
/// sample variance and the rest of what is expected.
///
/// @param units      their noise, without factors; `factor` and `shared` are not read
/// @param outputs    which output each row of a unit is, one list a unit
/// @param tolerance  of the largest relative change of a level in one step
/// @throws InvalidInput  lists and shapes that do not fit
/// Source: [Patterson1971]; [Harville1977] for the iteration.
ResidualNoise estimate_residual_noise(const std::vector<RandomEffectsUnit>& units,
                                      const std::vector<std::vector<Eigen::Index>>& outputs, const OutputLevels& levels,
                                      double tolerance = 1e-6);

}  // namespace mottle::stats
