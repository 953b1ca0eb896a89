// The main job: a study's method run over its model and tests.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/could_hide.hpp"
#include "mottle/study/jobs/predict.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle::study {

struct UpdateWorkings;

/// What an update found.
struct UpdateOutcome {
  Study study;
  std::shared_ptr<const UpdateWorkings> workings = nullptr;  ///< model, tests and method; opaque, see problem()
  UpdatingResult result = {};
  Verdict verdict = {};
  CouldHide could_hide = {};
  std::optional<PredictionOutcome> prediction = std::nullopt;  ///< where the study has [predict]
  std::optional<std::string> numbering = std::nullopt;  ///< a doubt whether modes numbered by rank are the same modes
  SolverUse solver_use = {};
  int ranks = 1;  ///< processes that shared the model's evaluations
  double reading_seconds = 0.0, updating_seconds = 0.0, assessing_seconds = 0.0;

  /// Model, parameters and tests as the method saw them last: with a surrogate for the model where the study has one.
  const UpdatingProblem& problem() const;
};

/// Updates. Where `settings` name a folder, its mottle.log tells what happens, its journal lets a killed update go on,
/// and results of an earlier run are set aside there; results are written by write_results().
///
/// Throws InvalidInput, FormatError, SystemFailure as the parts do; Stopped where a stop was requested: the journal
/// stays, and `resume` goes on from there.
UpdateOutcome update(const Study& study, const RunSettings& settings);

/// result.json, history.csv, cloud-initial.csv, cloud-final.csv, clouds.csv, tests.csv, study.toml; pairing.csv,
/// prediction.csv and modes.json where there is something to say. The journal and results that were set aside stay
/// until RunFolder::finish().
void write_results(const UpdateOutcome& outcome, const std::filesystem::path& folder);

/// The text of result.json; its `timings_s` end here.
std::string result_text(const UpdateOutcome& outcome);

/// @param folder  where the results and their report are
RunSummary summarise(const UpdateOutcome& outcome, const std::filesystem::path& folder);

}  // namespace mottle::study
