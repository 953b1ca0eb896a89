// The course of an update, of a study file or of a model that a program gives.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/jobs/update.hpp"
#include "study/jobs/update_plan.hpp"

namespace mottle::study {

/// @param start  when the job began, by steady_seconds()
UpdateOutcome update_by_plan(const Study& study, UpdatePlan plan, double start, const RunSettings& settings);

}  // namespace mottle::study
