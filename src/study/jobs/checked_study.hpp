// The objects of a checked study: model, tests and method, before anything is computed.
#pragma once

#include <optional>

#include "mottle/layers.hpp"
#include "study/jobs/update_plan.hpp"

namespace mottle::study {

/// Of a study whose parameters are not updated to tests, the model alone.
struct CheckedStudy {
  std::optional<UpdatePlan> plan = std::nullopt;
  std::optional<StudyModel> alone = std::nullopt;

  const StudyModel& made() const { return plan ? plan->made : *alone; }
};

/// The study's parameters, or those of its truth where it has no others.
inline const StudyParameters& parameters_of(const Study& study) {
  return study.parameters.list.empty() ? study.truth->parameters : study.parameters;
}

}  // namespace mottle::study
