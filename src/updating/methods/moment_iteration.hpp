// The iteration that perturbation, covariance adjustment and moment matching share: mean and covariance of the
// parameters move until the model's outputs have the tests' mean and, noise taken off, their covariance.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/stats/sampling/gaussian_rules.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {

/// How much a residual counts.
enum class MomentWeighting {
  variance,    ///< by the tests' variance of each output
  covariance,  ///< by the inverse of the tests' covariance
};

/// A population on the parameters' scales and what the model makes of it.
struct MomentState {
  Eigen::VectorXd mean;               ///< of t [parameter]
  Eigen::MatrixXd covariance;         ///< of t [parameter x parameter]
  Eigen::VectorXd output_mean;        ///< [output]
  Eigen::MatrixXd output_covariance;  ///< without measurement noise [output x output]
  Eigen::MatrixXd sensitivity;        ///< dy/dt at the mean [output x parameter]
  Cloud cloud = {};                   ///< the runs behind it, where they are a cloud
};

/// A method: what the outputs of a population are, and how its covariance follows the tests'.
struct MomentMethod {
  std::string name;
  MomentWeighting weighting = MomentWeighting::variance;
  /// Fills everything but mean and covariance; false where the model fails at the mean. Counts its runs.
  std::function<bool(MomentState& state, std::int64_t& evaluations)> evaluate;
  /// S <- (I - TG) S (I - TG)' + T (V - R) T' instead of S <- S + T (V - R - C) T'.
  bool replaces_covariance = false;
  std::string note;  ///< what a reader of its numbers must know
};

/// Runs the iteration from the prior.
///
///   mu <- mu + T (z - y(mu, S)),   within the bounds;   T = (G'WG)^-1 G'W, of least change where G has no full rank
///   S <- S + T (V - R - C(mu, S)) T',   in the groups of the problem, made positive semi-definite
///
/// A step that raises |W^1/2 (z - y)|, or that would move a parameter by more than two prior deviations, is damped
/// (Levenberg). It ends when no mean and no deviation moves by more than the
/// problem's tolerance times the prior deviation.
///
/// Throws InvalidInput: fewer than two specimens, covariance weighting with a singular covariance of the tests;
/// SystemFailure: the model fails at the prior mean.
UpdatingResult iterate_moments(const UpdatingProblem& problem, const ScaledParameters& parameters,
                               const MomentMethod& method, const RunContext& context);

/// What the specimens show of the state's population, each of them seen through the sensitivity at the mean
/// (population_evidence). A parameter that no output moves has no degrees of freedom.
PopulationEvidence moment_evidence(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                   const MomentState& state);

/// f and dy/dt at the state's mean; false where the model fails there. `outputs`: f.
bool evaluate_at_mean(const UpdatingProblem& problem, const ScaledParameters& parameters, MomentState& state,
                      Eigen::VectorXd& outputs, const RunContext& context, std::int64_t& evaluations);

/// Mean and covariance of the outputs over the state's population by a rule of points and weights. Points that are
/// physically impossible or fail take the value of a quadratic surface through the
/// others.
///
/// @return  false where too much of the population is physically impossible
/// Throws SystemFailure: too many runs fail.
bool evaluate_by_rule(const UpdatingProblem& problem, const ScaledParameters& parameters, const GaussianRule& rule,
                      MomentState& state, const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
