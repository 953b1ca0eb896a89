// The job of `mottle diagnose`: which candidate parameter best explains the misfit that the parameters leave.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/chains/evidence_comparison.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/updating/diagnosis/diagnosis.hpp"

namespace mottle::study {

/// Evidence of the tests under the study's parameters, alone or with one candidate.
struct ModelEvidence {
  std::string candidate = {};  ///< empty: the parameters alone
  EstimatedEvidence evidence = {};
  bool is_converged = false;      ///< the sampling of its posterior
  ModelProbability against = {};  ///< the other models
  std::int64_t model_evaluations = 0;
  std::string failure = {};  ///< why there is no evidence; empty: there is
};

/// Models of a diagnosis compared by evidence; none where the study does not ask for it.
struct DiagnosisEvidence {
  std::string method = {};  ///< that sampled the posteriors
  std::vector<ModelEvidence> models = {};
};

struct DiagnoseOutcome {
  Study study;
  Study whole;  ///< with the candidates as parameters
  Diagnosis diagnosis = {};
  DiagnosisEvidence evidence = {};
  Eigen::Index outputs = 0;  ///< number of them
  std::vector<std::string> output_names = {};
  std::string drawing = {};  ///< JSON: the model and the elements of each candidate; empty: it cannot be drawn
  int ranks = 1;             ///< processes that shared the model's evaluations
  double seconds = 0.0;
};

/// How far a diagnosis goes, and who is told what is known early.
struct DiagnoseChoices {
  /// Fits all candidates, however many. Else `diagnose.screened` of them, and of a model with 500 equations and more
  /// the best four.
  bool is_thorough = false;
  /// Called once with the linear answer, before any candidate is fitted; its write_results() may be called.
  std::function<void(const DiagnoseOutcome&)> linear_answer = {};
};

/// Folder and errors as with update(); log and journal are diagnosis.log and diagnosis.journal.
DiagnoseOutcome diagnose(const Study& study, const RunSettings& settings, const DiagnoseChoices& choices = {});

/// diagnosis.json, and diagnosis-model.json where the model can be drawn. Of a fitted answer: the journal and the
/// diagnosis of an earlier run are no longer needed then.
void write_results(const DiagnoseOutcome& outcome, const std::filesystem::path& folder);
/// The text of diagnosis.json.
std::string result_text(const DiagnoseOutcome& outcome);
RunSummary summarise(const DiagnoseOutcome& outcome, const std::filesystem::path& folder);

}  // namespace mottle::study
