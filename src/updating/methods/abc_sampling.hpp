// The second part of `abc`: which populations simulate tests like those measured, and how sure that is.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/abc.hpp"
#include "mottle/updating/sampling/approximate_posterior.hpp"
#include "updating/methods/abc_summary.hpp"

namespace mottle::updating {

/// Tests simulated at a population: their distances from its cloud, and the populations nearest to them.
struct SimulatedStudies {
  std::vector<Eigen::MatrixXd> tests;  ///< as distances see them, a study each [specimen x output]
  Eigen::VectorXd distances;           ///< [study]
  Eigen::MatrixXd estimates;           ///< [study x coordinate]
};

/// What sampling found.
struct SampledPopulations {
  AcceptedDraws draws;     ///< as accepted and adjusted
  Eigen::VectorXd median;  ///< of them [coordinate]
  IntervalCalibration calibration;
  double fraction = 1.0;  ///< accepted
  Eigen::Index calibration_sets = 0;
  /// ln sd of the nearest population, with what makes its variance unbiased in simulated studies [parameter].
  Eigen::VectorXd log_deviation;
  std::vector<AbcStage> stages;
  double simulated_distance = 0.0;
  double exceeded = 1.0;
  SimulatedStudies studies;  ///< at the draws' mean
  Eigen::VectorXd estimate;  ///< of the tests as the studies are estimated [coordinate]
  Eigen::VectorXd log_bias;  ///< taken off ln sd of an estimate [parameter]

  Eigen::MatrixXd mean_displacement;  ///< by the model's error, in each draw; empty: there is none [draw x parameter]

  /// Draws stretched about their medians by the factors of the calibration, displaced by the model's error
  /// [draw x coordinate].
  Eigen::MatrixXd stretched(const PopulationCoordinates& coordinates) const;
};

/// Samples p(population | summary of the tests) by approximate Bayesian computation in three stages.
///
/// The summary of a set of tests is the gradient of its distance from a reference cloud, in units of its own scatter:
/// where to the tests would move that cloud. The prior is flat in means, in partial correlations and in ln of levels,
/// and proportional to sd^2 / (sd^2 + noise_share^2) in ln sd: flat in ln sd where there is no noise, flat in sd^2
/// below it.
///
/// @throws Stopped  on request
SampledPopulations sample_populations(const UpdatingProblem& problem, const PopulationCoordinates& coordinates,
                                      const NearestPopulation& nearest, const RoughKnowledge& known,
                                      const AbcOptions& options, const RunContext& context);

}  // namespace mottle::updating
