// What errors in the numbers of a model that no parameter moves could hide behind a verdict: gathers the model's
// derivatives, the power of the verdict is src/updating/verdict/hidden_errors.
#pragma once

#include <string>
#include <vector>

#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/verdict/hidden_errors.hpp"
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle {

/// A hidden error with the name of the number that it is of.
struct NamedError {
  std::string name;
  double nominal = 0.0;
  double size = 0.0;  ///< of relative changes: the number itself, of a zero the size of its kind
  HiddenError error;

  double change() const { return error.relative_change * size; }
};

/// Errors that could hide.
struct CouldHide {
  std::vector<NamedError> errors;      ///< the most harmful first, a dozen at most
  bool is_level_known = false;         ///< the test of the means knows the noise; else its level is estimated
  std::vector<std::string> sentences;  ///< where undecided: the most harmful, and which further outputs would show them
  std::vector<std::string> notes;      ///< what was not looked at
  std::string summary;                 ///< one line; empty where nothing is known
};

/// For each number of the model that no parameter moves: the error that the verdict's test of the means refuses with
/// probability 0.8 (10 % where it refuses none), and how far that moves the estimated means, in half-widths of their
/// 95 % intervals. Costs one more model build and one Jacobian at the updated mean; nothing is worked out for models
/// by command and CalculiX decks, nor where the verdict is "inadequate".
///
/// Where the verdict is undecided, also: the cheapest set of further outputs, measured to 0.1 % (frequencies) and 1 %
/// of their size (shapes), with which those errors would be refused before they move a mean out of its interval.
CouldHide find_could_hide(const Study& study, const StudyModel& made, const UpdatingProblem& problem,
                          const UpdatingResult& result, Conclusion conclusion, const RunContext& context);

}  // namespace mottle
