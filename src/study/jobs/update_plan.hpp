// Everything of an update that is made before its first model run, for `update` and `check`.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "study/jobs/prediction_plan.hpp"

namespace mottle::study {

struct UpdatePlan {
  StudyModel made;
  StudyTests tests;
  std::unique_ptr<Updater> method;
  std::vector<int> covariance_groups;
  std::optional<PredictionPlan> prediction;
  std::shared_ptr<const Model> given = nullptr;  ///< by a program, in place of `made.model`, which is null then

  const Model& model() const;
  /// null where the model has none.
  const DifferentiableModel* derivatives() const;
};

/// Of everything that the results depend on and that can be seen: see study_fingerprint(); of a given model the study's
/// text and the tests.
Digest fingerprint_of(const Study& study, const UpdatePlan& plan);

/// Throws InvalidInput, FormatError: whatever of the study, its tests or its prediction does not fit the model.
UpdatePlan plan_update(const Study& study, const RunSettings& settings);

/// Throws InvalidInput where results in that folder would be written over what the study reads.
void require_place_of_update(const Study& study, const std::filesystem::path& folder);

/// The plan's problem over `model`, which must outlive it as the plan must.
UpdatingProblem problem_of(const Study& study, const UpdatePlan& plan, const Model& model);

/// Lets the method, and the surrogate where there is one, begin, up to their first model run.
///
/// Throws InvalidInput: what they refuse (too few specimens, more parameters than outputs, ...).
void refuse_what_methods_refuse(const Study& study, const UpdatePlan& plan, const RunContext& context);

}  // namespace mottle::study
