// The job of `mottle init`: a first study of a deck and its tests, with reasons, that runs as it is.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// What is known; what is not is proposed.
struct InitSettings {
  std::filesystem::path model;              ///< a Nastran deck
  std::vector<std::string> tests = {};      ///< files, folders or patterns as of test.file; none: a study without tests
  std::filesystem::path study = {};         ///< where the study will be: its paths are relative to that
  std::set<std::string> ignore_cards = {};  ///< in capitals
  std::optional<std::string> units = {};    ///< "SI", ...
  std::optional<std::vector<int>> modes = {};            ///< that are outputs, in the model's numbers
  std::optional<std::vector<std::string>> targets = {};  ///< of the parameters
};

/// A mode of the model with what the tests say of it.
struct InitMode {
  int mode = 0;            ///< the model's number
  double model = 0.0;      ///< its frequency, unit of the study
  double test_mean = 0.0;  ///< nan: not tested
  double test_std = 0.0;   ///< nan: tested in fewer than two specimens
  int specimens = 0;       ///< in which it was found
  double mac = 0.0;        ///< mean over them; nan: paired by frequency
  std::string doubt = {};  ///< why it is no output; empty: it is one
};

/// A number of the deck with its place in the study.
struct InitParameter {
  std::string target = {}, name = {}, unit = {};
  double value = 0.0;
  int elements = 0;
  double spread = 0.0;  ///< proposed standard deviation, as a fraction of the value
  std::string spread_reason = {};
  int mode = 0;               ///< output that it changes most
  double sensitivity = 0.0;   ///< of that, % per %
  std::string left_out = {};  ///< why it is no parameter; empty: it is one
};

struct InitOutcome {
  InitSettings settings;  ///< with what was proposed for what was not known
  std::string units_reason = {};
  std::string pairing = {};  ///< "mac", "frequency", "order"; empty: no tests
  int specimens = 0;
  std::vector<InitMode> modes = {};
  std::vector<InitParameter> parameters = {};  ///< those of the study first, then what was left out
  std::vector<std::string> notes = {};
  std::string text = {};  ///< of the study
};

/// Solves the deck, reads and pairs the tests, and proposes outputs and parameters:
///
/// - outputs are the elastic modes that are paired beyond doubt in at least half of the specimens, the lowest 14;
/// - parameters are numbers of the deck chosen one after the other, each the one that changes the outputs most (in
///   units of the tests' scatter, by its prior standard deviation) in a way that those chosen before cannot; at most
///   half as many as outputs. What the others lack is said.
///
/// Nothing is written.
///
/// @throws InvalidInput, FormatError  a deck or tests that cannot be read, no output or parameter left
/// @throws SystemFailure              the modes do not converge
InitOutcome propose_study(const InitSettings& settings);

/// The tables of modes and parameters, and what to do next.
RunSummary summarise(const InitOutcome& outcome);

}  // namespace mottle::study
