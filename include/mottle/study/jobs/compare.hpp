// The job of `mottle compare`: results of several updates side by side.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/chains/evidence_comparison.hpp"
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

/// A run's model among those whose evidences are of the same tests.
struct ComparedModel {
  std::string label;  ///< of its run
  EstimatedEvidence evidence;
  ModelProbability against = {};  ///< the others
  /// Expected log predictive density by leave-one-out; its difference to the largest among the models, with the
  /// standard error from specimen to specimen; nan: not known.
  double elpd = std::numeric_limits<double>::quiet_NaN();
  double elpd_difference = std::numeric_limits<double>::quiet_NaN();
  double elpd_standard_error = std::numeric_limits<double>::quiet_NaN();
  double largest_pareto_k = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd elpd_pointwise = {};  ///< of each specimen
};

/// Evidences that can be compared, and what stands against comparing the others.
struct EvidenceComparison {
  std::vector<ComparedModel> models;  ///< in the order of the runs; none or two and more
  struct LeftOut {
    std::string label, reason;
  };
  std::vector<LeftOut> left_out = {};
  std::vector<std::string> warnings = {};  ///< sentences: what else than the models differs, and doubtful evidences
};

struct Comparison {
  std::vector<ComparedRun> runs;
  std::optional<EvidenceComparison> evidence = std::nullopt;  ///< where a run has one
};

/// Reads the results of updates.
///
/// Throws InvalidInput: a folder without results of an update, fewer than two folders.
Comparison compare_runs(const std::vector<std::filesystem::path>& folders);

/// A table for a person, a column a run.
RunSummary summarise(const Comparison& comparison);

}  // namespace mottle::study
