// How many runs of its program an update will take.
#pragma once

#include <optional>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/check.hpp"
#include "study/jobs/update_plan.hpp"

namespace mottle::study {

/// Runs of the update of a model that is linear in its parameters, in place of the study's, counted by updating it; a
/// run that was made is not made again. Nothing: the method does not get through on such a model.
///
/// @param plan  of a model by runs of a program
std::optional<ExpectedRuns> count_expected_runs(const Study& study, const UpdatePlan& plan, const RunContext& context);

}  // namespace mottle::study
