// The jobs that only run the model forward: propagate, simulate.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/jobs/study_model.hpp"
#include "mottle/updating/methods/cloud.hpp"

namespace mottle::study {

/// The forward cloud.
struct PropagateOutcome {
  Study study;
  StudyModel made;
  Cloud cloud = {};
  SolverUse solver_use = {};
  int ranks = 1;  ///< processes that shared the model's evaluations
  double seconds = 0.0;
};

/// Draws the parameters' cloud and runs the model over it. Folder and errors as with update().
///
/// @param points  where given, a CSV of parameter vectors (header = parameter names) that replaces the drawn cloud
PropagateOutcome propagate(const Study& study, const std::optional<std::filesystem::path>& points,
                           const RunSettings& settings);

/// cloud.csv, clouds.csv, result.json, study.toml.
void write_results(const PropagateOutcome& outcome, const std::filesystem::path& folder);
/// The text of result.json; its `timings_s` end here.
std::string result_text(const PropagateOutcome& outcome);
RunSummary summarise(const PropagateOutcome& outcome, const std::filesystem::path& folder);

/// Specimens drawn from [truth].
struct SimulateOutcome {
  Study study;
  StudyModel made;
  Cloud cloud = {};            ///< outputs as a test would give them
  Eigen::MatrixXd exact = {};  ///< and without the measurement's noise [specimen x output]
};

/// Specimens of an earlier run are set aside as update() does it.
///
/// Throws InvalidInput: no [truth], a noise rule that fits no output; SystemFailure where the model fails.
SimulateOutcome simulate(const Study& study, const RunSettings& settings);

/// specimens.csv, specimens-truth.csv (their parameters and exact outputs), study.toml.
void write_results(const SimulateOutcome& outcome, const std::filesystem::path& folder);
RunSummary summarise(const SimulateOutcome& outcome, const std::filesystem::path& folder);

}  // namespace mottle::study
