// The [predict] block of a study: planned before an update, run at its end.
#pragma once

#include <memory>
#include <optional>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/predict.hpp"
#include "mottle/study/jobs/study_objects.hpp"

namespace mottle::study {

/// What [predict] needs, made before anything long is computed.
struct PredictionPlan {
  StudyModel made;
  std::unique_ptr<const Model> model = nullptr;  ///< made.model, shared out over ranks where there are any
  std::optional<StudyTests> held_out = std::nullopt;
  Eigen::VectorXd repeatability = {};  ///< standard deviation of each output; nan: as in the update
};

/// Throws InvalidInput: an override that the model does not have or that a parameter acts on, outputs or held-out tests
/// as make_model and read_tests.
PredictionPlan plan_prediction(const Study& study, const RunSettings& settings);

/// Throws SystemFailure as predict().
PredictionOutcome run_prediction(const Study& study, const PredictionPlan& plan, const UpdatingProblem& problem,
                                 const UpdatingResult& result, const RunContext& context);

}  // namespace mottle::study
