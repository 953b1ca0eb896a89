// Which numbers of a deck a first study takes as parameters, and how far they may be off.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "mottle/study/jobs/targets.hpp"

namespace mottle::study {

/// Parameters by pivoted orthogonalisation of what they change: A(k, j) = sensitivity of output k to number j times its
/// proposed spread, over the scale of output k. The next is the one with the largest rest that the chosen ones cannot
/// give; a number is left out where its column is shorter than 1 (it moves no output by more than the scale), or its
/// rest less than 0.15 of its column (the tests can hardly tell it from the others).
///
/// @param targets  numbers of the deck with sensitivities of all modes
/// @param modes    outputs, by number from 1
/// @param scales   of their logarithms, of the tests' scatter [output]
/// @param wanted   targets that are parameters whatever they change; empty: they are proposed
std::vector<InitParameter> propose_parameters(const std::vector<Target>& targets, const std::vector<int>& modes,
                                              const Eigen::VectorXd& scales, const std::vector<std::string>& wanted);

}  // namespace mottle::study
