// Tests of the scatter that no parameter explains.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {

std::vector<std::string> output_names(const UpdatingProblem& problem);

/// How much of an output's own extra variance shows in the whitened directions that no parameter moves.
struct ResidualLeverage {
  Eigen::VectorXd leverage;  ///< whitened variance for an extra variance of 1 of the output [output]
  Eigen::VectorXd variance;  ///< of the output, as the model has it [output]
  std::vector<std::string> names;
};

/// Whether residuals in whitened directions scatter no more than noise of a known level: their squares about their
/// means against chi-squared.
///
/// @param squares    sum over specimens and directions
/// @param specimens  degrees of freedom of one direction
/// @param directions number of directions, >= 1
PlannedTest residual_scatter_test(double squares, double specimens, double directions,
                                  const ResidualLeverage& leverage);

/// Whether residuals in whitened directions scatter alike in all of them, as noise of an estimated level does: John's
/// statistic, brought to the mean of the chi-squared law that it tends to with many specimens.
///
///   U = tr[(S / (tr S / d) - I)^2] / d,   nu d U / 2 -> chi-squared with d (d + 1) / 2 - 1 degrees of freedom
///
/// @param scatter    S, sample covariance of the residuals in d >= 2 directions [direction x direction]
/// @param specimens  nu, its degrees of freedom
/// Source: [John1972]; [Ledoit2002] for few specimens and many directions.
PlannedTest sphericity_test(const Eigen::Ref<const Eigen::MatrixXd>& scatter, double specimens,
                            const ResidualLeverage& leverage);

/// Specimens that have each output, 0 of an output that does not scatter among them beyond the last digits of its
/// values: how much it does by itself is then not known.
Eigen::VectorXi counts_with_scatter(const TestMoments& tests);

}  // namespace mottle::updating
