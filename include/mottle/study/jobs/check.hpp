// The job of `mottle check`: a summary of a study, and whether an update would be refused.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// Programs that a study runs and files that it reads outside its own folder, to judge a study from an unknown source.
struct StudyReach {
  std::vector<std::string> programs;  ///< "model.command: python3 solver.py"
  std::vector<std::string> outside;   ///< "test.file: /data/tests.csv", links followed
};

/// The model, tests and method, opaque: src/study/jobs/checked_study.hpp.
struct CheckedStudy;

/// Runs of the program that an update takes if outputs are linear in the parameters, clouds included.
struct ExpectedRuns {
  std::int64_t count = 0;  ///< 0: not known, or the model is not solved by runs of a program
  bool is_cut = false;     ///< counting ended there: there are more
};

struct CheckOutcome {
  Study study;
  std::shared_ptr<const CheckedStudy> checked = nullptr;
  Eigen::VectorXd frequencies = {};  ///< the ten lowest at the parameters' means, in Hz; none without outputs of modes
  Eigen::VectorXd outputs = {};      ///< there; nan where the model was not run for them
  /// Changes of the outputs by one prior standard deviation of each parameter, as a fraction of the output; none where
  /// the model has no cheap derivatives [output x parameter].
  Eigen::MatrixXd changes = {};
  double solution_seconds = 0.0;  ///< of one sample; 0: not measured
  double total_mass = 0.0;        ///< there
  ExpectedRuns expected_runs = {};
  StudyReach reach = {};
};

/// Reads everything and refuses whatever update() would refuse before its first cloud. Computes nothing long, writes
/// nothing into the folder of `settings`; a solver by command is run once.
CheckOutcome check(const Study& study, const RunSettings& settings);

RunSummary summarise(const CheckOutcome& outcome);

}  // namespace mottle::study
