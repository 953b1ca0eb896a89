// The [predict] block of a study, run at the end of an update.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/prediction/prediction.hpp"

namespace mottle {

/// What [predict] needs, made before anything long is computed.
struct PredictionPlan {
  StudyModel made;
  std::optional<StudyTests> held_out;
  Eigen::VectorXd repeatability;  ///< standard deviation of each output; nan: as in the update
};

/// Throws InvalidInput: an override that the model does not have or that a parameter acts on, outputs or held-out tests
/// as make_model and read_tests.
PredictionPlan plan_prediction(const Study& study, const RunSettings& settings);

/// What a study's prediction says.
struct PredictionOutcome {
  PredictionSettings settings;
  Prediction prediction = {};
  std::optional<HeldOutCheck> check = std::nullopt;
  std::vector<std::string> notes = {};  ///< sentences
};

/// Throws SystemFailure as predict().
PredictionOutcome run_prediction(const Study& study, const PredictionPlan& plan, const UpdatingProblem& problem,
                                 const UpdatingResult& result, const RunContext& context);

}  // namespace mottle
