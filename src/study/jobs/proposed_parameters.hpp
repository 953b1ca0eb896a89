// Which numbers of a deck a first study takes as parameters, and how far they may be off.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "mottle/study/jobs/targets.hpp"
#include "study/jobs/repeated_modes.hpp"

namespace mottle::study {

/// What the tests see.
struct ProposedOutputs {
  std::vector<int> modes;              ///< by number from 1
  Eigen::VectorXd scales;              ///< of their logarithms, of the tests' scatter [output]
  std::vector<ModeGroup> groups = {};  ///< modes of the model that have one frequency
};

/// Parameters by pivoted orthogonalisation of what they change: A(k, j) = sensitivity of output k to number j times its
/// proposed spread, over the scale of output k. The next is the one with the largest rest that the chosen ones cannot
/// give; a number is left out where its column is shorter than 1 (it moves no output by more than the scale), or its
/// rest less than 0.15 of its column (the tests can hardly tell it from the others).
///
/// In modes of one frequency a number's sensitivities are the eigenvalues of the derivative on the space that they
/// span; its eigenvectors are not known. Their mean, a multiple of the identity, is an entry like others; what is left
/// is taken for a direction of the number's own, so that no number is called like another for equal eigenvalues.
///
/// @param targets  numbers of the deck with sensitivities of all modes
/// @param wanted   targets that are parameters whatever they change; empty: they are proposed
std::vector<InitParameter> propose_parameters(const std::vector<Target>& targets, const ProposedOutputs& outputs,
                                              const std::vector<std::string>& wanted);

}  // namespace mottle::study
