// Tests of residuals whose noise is estimated from them, by simulated studies.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "updating/population/mean_residuals.hpp"
#include "updating/population/population_fit.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {

/// Plans two tests of a fit whose noise is estimated from its residuals; noise that differs from output to output is
/// never evidence against the model:
///
///   mean-residuals: the squares of the mean residuals, in units of the noise, in the directions that no parameter
///   moves; scatter-of-residuals: the largest variance of the residuals in any of these directions, which grows where
///     something that is no parameter moves several outputs together.
///
/// Both are compared with those of simulated studies: the same linear problem, the same gaps, noise of the estimated
/// levels (and the model's error) alone, levels estimated anew. The second is left out where the residuals determine
/// the levels and no more.
///
/// @param values     the tests; only which are nan counts [specimen x output]; they and `fit` outlive the plan
/// @param residuals  of the fit, of at least one direction
/// @param level      of the verdict: how many studies are simulated
void plan_tests_of_unknown_noise(const Eigen::MatrixXd& values, const PopulationFit& fit,
                                 const MeanResiduals& residuals, double level, TestPlan& plan);

}  // namespace mottle::updating
