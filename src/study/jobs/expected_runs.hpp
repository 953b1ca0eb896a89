// How many runs of its program an update will take.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/check.hpp"
#include "study/jobs/update_plan.hpp"

namespace mottle::study {

/// Number of program runs that the study's update needs if outputs are linear in the parameters: counted by updating
/// such a model in place of the study's; a run that was made is not made again.
///
/// @param plan  of a model that is solved by runs of a program
ExpectedRuns count_expected_runs(const Study& study, const UpdatePlan& plan, const RunContext& context);

/// In a sentence without its end, with the time that they take.
///
/// @param seconds  of one run; 0: not known
std::string expected_runs_text(const ExpectedRuns& expected, double seconds, int max_parallel);

/// Tells the user what an update by runs of a program begins.
void note_expected_runs(const Study& study, const UpdatePlan& plan, const RunContext& context);

}  // namespace mottle::study
