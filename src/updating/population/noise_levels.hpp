// The level of the measurement's noise, of each output by itself where the residuals tell them apart.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::updating {

struct PopulationFit;

/// What is known of the measurement's noise: variance = base * factor.
struct NoiseModel {
  Eigen::VectorXd base;     ///< variance [output]
  std::vector<int> factor;  ///< index of the factor on each output's base, -1: base is the variance [output]
  int factors = 0;
};

/// Noise of these variances, none of them to be estimated.
NoiseModel known_noise(Eigen::VectorXd variance);

/// Noise as the residuals show it that no parameters of the specimens and no means of the outputs take up.
struct NoiseOfResiduals {
  Eigen::VectorXd variance;  ///< [output]
  NoiseModel common = {};    ///< what one level for each kind of output would make of it
  bool has_own_levels = false;
  double degrees_of_freedom = 0.0;  ///< 0: the residuals tell nothing, and the variances are the base
};

/// The common level of each kind of output, and from there the level of each output, held to the common one with the
/// weight of four observations, where the covariance of the residuals has at least as many entries as there are levels.
///
/// @param units  the linear problem of the specimens, noise without factors
NoiseOfResiduals noise_of_residuals(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                    const std::vector<RandomEffectsUnit>& units, const NoiseModel& noise,
                                    double tolerance = 1e-6);

/// Estimates the noise of a fit from the residuals of its linear problem, which then has that noise and no factors; no
/// output's is larger than the scatter of its tests. Where there are no residuals, the population's own fit estimates
/// it.
void take_noise_of_residuals(const Eigen::Ref<const Eigen::MatrixXd>& values, const NoiseModel& noise,
                             PopulationFit& fit);

}  // namespace mottle::updating
