// Which numbers of a deck a first study takes as parameters, and how far they may be off.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "mottle/study/jobs/targets.hpp"
#include "study/proposal/sensitive_numbers.hpp"

namespace mottle::study {

struct ProposedParameters {
  std::vector<InitParameter> list = {};  ///< those of the study first, then what was left out
  std::vector<std::string> notes = {};
};

/// With tests the numbers that explain these by likelihood, see select_explanatory(): about the deck's numbers first,
/// then about the mean that the chosen ones explain, until both stay. Without tests, or where nothing needs an
/// explanation, the numbers that change the outputs most, see SensitiveNumbers. At most 12, with tests two fewer than
/// outputs, without half as many.
///
/// @param outcome  with outputs, pairing and shapes; its targets are parameters whatever they change
/// @param targets  numbers of the deck with sensitivities of all modes
/// @throws InvalidInput  a target that the deck does not have, tests that cannot be read
ProposedParameters propose_parameters(const InitOutcome& outcome, const std::vector<Target>& targets,
                                      const ProposedOutputs& outputs);

}  // namespace mottle::study
