// Tests of an update of one structure.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// What the tests need beside mean, covariance and sensitivity, which are the result's.
struct StructureEstimate {
  Eigen::VectorXd residual;         ///< tested less the model's [output]
  Eigen::VectorXd measurement_std;  ///< of one test [output]
  Eigen::VectorXd free_step;        ///< from the mean to where it would be without bounds [parameter]
};

/// Puts the tests into the result:
///
///   residuals: r' B (B' W^-1 B)^-1 B' r, B the directions that no parameter moves, against chi-squared;
///   bounds, prior-shift: see mean_limits.hpp.
void test_structure(const UpdatingProblem& problem, const StructureEstimate& estimate, UpdatingResult& result);

}  // namespace mottle::updating
