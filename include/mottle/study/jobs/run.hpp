// The jobs that a study can be given: each makes the objects, computes, and leaves its files in a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle {

/// Where and how a job runs.
struct RunSettings {
  std::filesystem::path folder;
  std::filesystem::path cache{};  ///< folder of what later runs may use again; empty: none. Changes no number
  int threads = 1;
  bool resume = false;
  bool may_run_programs = true;  ///< else a study whose model is run by a program is refused
  ProgressObserver* observer = nullptr;
  const std::atomic<bool>* stop = nullptr;
};

/// What a job says at its end; everything else is in its folder.
struct RunSummary {
  std::string status;
  std::string message;
  std::vector<std::string> lines;  ///< for a person
  std::string json;                ///< for a machine: one line
};

/// The main job: result.json, history.csv, cloud-initial.csv, cloud-final.csv, clouds.csv, tests.csv, study.toml.
///
/// Errors: InvalidInput, SystemFailure as the parts throw them; Stopped where a stop was requested: the journal stays
/// and `resume` goes on from there.
RunSummary run_update(const Study& study, const RunSettings& settings);

/// The forward cloud: cloud.csv, result.json, clouds.csv, study.toml.
///
/// @param points  where given, a CSV of parameter vectors (header = parameter names) that replaces the drawn cloud
RunSummary run_propagate(const Study& study, const std::optional<std::filesystem::path>& points,
                         const RunSettings& settings);

/// Specimens drawn from [truth]: specimens.csv (outputs as a test would give them), specimens-truth.csv (their
/// parameters), study.toml.
RunSummary run_simulate(const Study& study, const RunSettings& settings);

/// Which candidate, beside the parameters, best explains what they cannot: diagnosis.json, diagnosis.log.
///
/// Errors: as run_update.
RunSummary run_diagnose(const Study& study, const RunSettings& settings);

/// Reads everything, refuses whatever run_update would refuse before its first cloud, and says what would run, with the
/// programs and the files outside of the study's folder. Computes nothing long, writes nothing into `folder`; a solver
/// by command is run once.
RunSummary run_check(const Study& study, const RunSettings& settings);

}  // namespace mottle
