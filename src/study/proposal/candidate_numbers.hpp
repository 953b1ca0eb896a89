// Numbers of a deck as candidates of a first study: how far each may be off, and which are tied as twins.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "mottle/study/jobs/targets.hpp"
#include "study/jobs/repeated_modes.hpp"

namespace mottle::study {

/// A parameter that could be: one number, or twins that change the outputs alike.
struct CandidateNumber {
  InitParameter parameter;
  double preference = 0.0;              ///< ln prior odds: joints and supports are seldom known, dimensions mostly
  Eigen::RowVectorXd sensitivity = {};  ///< of the modes, sum over the twins, % per %; nan of rigid-body modes [mode]
};

/// Numbers of the deck in their order, twins at the place of the first: numbers of one kind of card, field and value
/// whose sensitivities agree within a few per cent in all modes. Numbers that split a frequency of several modes are
/// none: they may change other combinations of these modes.
///
/// @param modes   that are outputs, by number from 1
/// @param groups  modes of the model that have one frequency
/// @param may_tie  whether twins are tied
std::vector<CandidateNumber> candidate_numbers(const std::vector<Target>& targets, const std::vector<int>& modes,
                                               const std::vector<ModeGroup>& groups, bool may_tie);

}  // namespace mottle::study
