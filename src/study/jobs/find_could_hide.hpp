// Gathers the model's derivatives by the numbers that no parameter moves; the power of the verdict against errors in
// them is src/updating/verdict/hidden_errors.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/could_hide.hpp"
#include "mottle/study/jobs/study_model.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle::study {

/// For each number of the model that no parameter moves: the error that the verdict's test of the means refuses with
/// probability 0.8 (10 % where it refuses none), and how far that moves the estimated means, in half-widths of their
/// 95 % intervals. Costs one more model build and one Jacobian at the updated mean; nothing is worked out for models
/// by command and CalculiX decks, nor where the verdict is "inadequate".
///
/// Where the verdict is undecided, also: the cheapest set of further outputs, measured to 0.1 % (frequencies) and 1 %
/// of their size (shapes), with which those errors would be refused before they move a mean out of its interval.
CouldHide find_could_hide(const Study& study, const StudyModel& made, const UpdatingProblem& problem,
                          const UpdatingResult& result, Conclusion conclusion, const RunContext& context);

}  // namespace mottle::study
