// Fits every specimen by itself, held by the population that it comes from: all specimens together, in batches.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {

/// The population that holds the fits, on the parameters' own scales t.
struct HoldingPopulation {
  Eigen::VectorXd mean;        ///< mu [parameter]
  Eigen::MatrixXd covariance;  ///< Sigma, positive semi-definite [parameter x parameter]
  Eigen::VectorXd noise;       ///< variance of each output's measurement, may be 0 [output]
};

/// Fitted specimens.
struct SpecimenFits {
  Eigen::MatrixXd points;                       ///< t [specimen x parameter]
  Eigen::MatrixXd outputs;                      ///< f there [specimen x output]
  std::vector<Eigen::MatrixXd> jacobians = {};  ///< df/dt at `differentiated`, one a specimen [output x parameter]
  std::vector<bool> converged = {};
  Eigen::VectorXd costs = {};           ///< what was minimised, noise below a floor counted as that floor [specimen]
  Eigen::MatrixXd differentiated = {};  ///< where the Jacobians were taken [specimen x parameter]

  /// Puts a specimen of other fits in the place of one of these.
  void take(Eigen::Index specimen, const SpecimenFits& other, Eigen::Index from);
};

/// Where fits start.
struct SpecimenStart {
  Eigen::MatrixXd points;                       ///< t [specimen x parameter]
  std::vector<Eigen::MatrixXd> jacobians = {};  ///< about right; empty: from differences there
  double tolerance = 1e-8;                      ///< a step below this, in prior standard deviations, is the last
  Eigen::MatrixXd outputs = {};                 ///< f there; empty: it is evaluated [specimen x output]
  /// Where `jacobians` were taken by scaled_jacobians() [specimen x parameter]. Those that come from differences stay
  /// where the fit ends within one step of the differences: taken anew they change by the error of the outputs over
  /// that step, and whoever alternates fits with an estimate goes round in a circle. Empty: all are taken anew.
  Eigen::MatrixXd differentiated = {};
};

/// Most probable parameters of every specimen,
///
///   t_s = argmin (z_s - f(t))' R^-1 (z_s - f(t)) + (t - mu)' Sigma^-1 (t - mu),
///
/// missing entries left out, by Gauss-Newton steps in the form t = mu + Sigma G' (G Sigma G' + R)^-1 (z - f + G (t -
/// mu)), halved where they do not help or where the model fails. With R = 0 it is the point nearest to the mean that
/// gives the test. Derivatives at start and end are those of scaled_jacobians(), between them Broyden's.
///
/// @param values       tests [specimen x output], nan: missing
/// @param population   what holds them
/// @param evaluations  raised by the model runs that were needed
/// @throws SystemFailure  the model fails at a specimen's start, or all around the starts of all
/// Source: [Lindstrom1990].
SpecimenFits fit_specimens(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                           const HoldingPopulation& population, const SpecimenStart& start, const RunContext& context,
                           std::int64_t& evaluations);

}  // namespace mottle::updating
