// The job of `mottle compare`: results of several updates side by side.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// What one update found of a parameter; nan: not known.
struct ComparedParameter {
  std::string name, unit;
  double prior_mean = 0.0, mean = 0.0, mean_lower = 0.0, mean_upper = 0.0;
  double standard_deviation = 0.0, std_lower = 0.0, std_upper = 0.0;
  std::string at_bound = {};  ///< "lower", "upper"; empty: not at one
};

/// One output of the updated model against the tests; nan: not known.
struct ComparedOutput {
  std::string name, unit;
  double test_mean = 0.0, initial_mean = 0.0, final_mean = 0.0;
  /// Standard deviation of the model with the measurement noise, over that of the tests.
  double scatter_ratio = 0.0;
};

struct ComparedRun {
  std::filesystem::path folder;
  std::string label;  ///< its folder's name, or more of its path where two are called the same
  std::string title, method, status, verdict;
  int specimens = 0;
  double seconds = 0.0;
  std::vector<ComparedParameter> parameters = {};
  std::vector<ComparedOutput> outputs = {};
};

struct Comparison {
  std::vector<ComparedRun> runs;
};

/// Reads the results of updates.
///
/// Throws InvalidInput: a folder without results of an update, fewer than two folders.
Comparison compare_runs(const std::vector<std::filesystem::path>& folders);

/// A table for a person, a column a run.
RunSummary summarise(const Comparison& comparison);

}  // namespace mottle::study
