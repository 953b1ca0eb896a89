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

/// Specimens that have each output, 0 of an output that does not scatter among them beyond the last digits of its
/// values: how much it does by itself is then not known.
Eigen::VectorXi counts_with_scatter(const TestMoments& tests);

}  // namespace mottle::updating
