// What errors in the numbers of a model that no parameter moves could hide behind a verdict: gathers the model's
// derivatives, the power of the verdict is src/updating/verdict/hidden_errors.
#pragma once

#include <string>
#include <vector>

#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/results/result_json.hpp"

namespace mottle {

/// Errors that could hide, the most harmful first.
struct CouldHide {
  Json list = Json::array();           ///< verdict.could_hide of result.json
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
