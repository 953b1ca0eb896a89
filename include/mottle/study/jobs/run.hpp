// What every job of a study is given and says: each is a function from a study to an outcome; write_results() leaves
// the outcome in a folder, summarise() puts it into words.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle {

/// Where and how a job runs.
struct RunSettings {
  std::filesystem::path folder{};  ///< empty: no log, no journal to resume from
  std::filesystem::path cache{};   ///< folder of what later runs may use again; empty: none. Changes no number
  int threads = 1;
  bool resume = false;
  bool may_run_programs = true;  ///< else a study whose model is run by a program is refused
  ProgressObserver* observer = nullptr;
  const std::atomic<bool>* stop = nullptr;  ///< a model made for the job may ask it for as long as it lives
};

/// What a job says at its end; everything else is in its folder.
struct RunSummary {
  std::string status;
  std::string message = {};
  std::vector<std::string> lines = {};  ///< for a person
  std::string json = {};                ///< for a machine: one line
};

/// Reads everything, refuses whatever update() would refuse before its first cloud, and says what would run, with the
/// programs and the files outside of the study's folder. Computes nothing long, writes nothing into `folder`; a solver
/// by command is run once.
RunSummary run_check(const Study& study, const RunSettings& settings);

}  // namespace mottle
