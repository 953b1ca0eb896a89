// Tests of an update of one structure, or of the mean of many.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// What the tests need beside mean, covariance and sensitivity, which are the result's.
struct StructureEstimate {
  int specimen = 0;                 ///< from 1; 0: the mean of all
  Eigen::VectorXd residual;         ///< tested less the means of specimens that scatter so; nan: not known [output]
  Eigen::VectorXd measurement_std;  ///< of one test [output]
  Eigen::VectorXd free_step;        ///< from the mean to where it would be without bounds [parameter]
};

/// Puts the tests into the result:
///
///   residuals: r' B (B' W^-1 B)^-1 B' r, B the directions that no parameter moves, against chi-squared;
///   bounds, prior-shift: see mean_limits.hpp.
///
/// A mean of n specimens with known repeatability has the variance of one divided by n; an error that is assumed is
/// taken to be common to all.
void test_structure(const UpdatingProblem& problem, const StructureEstimate& estimate, UpdatingResult& result);

}  // namespace mottle::updating
