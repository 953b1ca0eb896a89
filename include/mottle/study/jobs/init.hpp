// The job of `mottle init`: a first study of a model and its tests, with reasons, that runs as it is; of a solver by
// command one whose unknowns are marked.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// What is known; what is not is proposed.
struct InitSettings {
  std::filesystem::path model;          ///< a deck of Nastran or CalculiX (.inp), or a file with placeholders {{name}}
  std::vector<std::string> tests = {};  ///< files, folders or patterns as of test.file; none: a study without tests
  std::filesystem::path study = {};     ///< where the study will be: its paths are relative to that
  std::set<std::string> ignore_cards = {};               ///< in capitals
  std::optional<std::string> units = {};                 ///< "SI", ...
  std::optional<std::vector<int>> modes = {};            ///< that are outputs, in the model's numbers
  std::optional<std::vector<std::string>> targets = {};  ///< of the parameters
  std::filesystem::path cache = {};  ///< folder of CalculiX's matrices that later runs use again; empty: none
};

/// A mode of the model with what the tests say of it.
struct InitMode {
  int mode = 0;            ///< the model's number
  double model = 0.0;      ///< its frequency, unit of the study
  double test_mean = 0.0;  ///< nan: not tested
  double test_std = 0.0;   ///< nan: tested in fewer than two specimens
  /// The same by the median absolute deviation where there are enough specimens, which an outlier does not raise.
  double robust_std = std::numeric_limits<double>::quiet_NaN();
  int specimens = 0;        ///< in which it was found
  double mac = 0.0;         ///< mean over them; nan: paired by frequency
  std::string doubt = {};   ///< why it is no output; empty: it is one
  std::string remark = {};  ///< what to think of in a pair that is used
};

/// A number of the deck with its place in the study.
struct InitParameter {
  std::string target = {}, name = {}, unit = {};
  std::vector<std::string> twins = {};  ///< further targets of the same parameter
  double value = 0.0;
  int elements = 0;
  double spread = 0.0;  ///< proposed standard deviation, as a fraction of the value
  std::string spread_reason = {};
  int mode = 0;              ///< output that it changes most
  double sensitivity = 0.0;  ///< of that, % per %
  /// By which the ln likelihood of the tests falls without it; nan: no tests, or no parameter.
  double explained = std::numeric_limits<double>::quiet_NaN();
  std::string left_out = {};  ///< why it is no parameter; empty: it is one
};

/// Shapes of tables that are outputs.
struct InitShapes {
  std::vector<int> modes = {};  ///< by the model's number; empty: none
  std::vector<std::string> degrees_of_freedom = {};
  double size = 1.0;                                           ///< of the model's over the tests', median
  bool has_size() const { return size > 0.8 && size < 1.25; }  ///< they seem to be mass-normalised
};

struct InitOutcome {
  InitSettings settings;         ///< with what was proposed for what was not known
  std::string kind = "nastran";  ///< of the model: "nastran", "calculix", "command"
  std::string units_reason = {};
  std::string pairing = {};  ///< "mac", "frequency", "named"; empty: no tests
  int specimens = 0;
  std::vector<InitMode> modes = {};
  InitShapes shapes = {};
  std::vector<InitParameter> parameters = {};  ///< those of the study first, then what was left out
  std::vector<std::string> notes = {};
  std::string text = {};  ///< of the study
};

/// Solves the deck (CalculiX by its matrices, from a few runs for each number of the deck), reads and pairs the tests,
/// and proposes outputs and parameters:
///
/// - outputs are the elastic modes that are paired beyond doubt in at least half of the specimens, the lowest 14;
/// - parameters are the numbers of the deck that explain the tests: by the likelihood of their means and their scatter
///   in the linear model, stiffnesses of joints and supports before sections, masses, moduli and dimensions where the
///   tests cannot tell; numbers of one kind and value that change the outputs alike are one parameter; at most two
///   fewer than outputs, and twelve. Without tests they are the numbers that change the outputs most in a way that
///   others cannot, at most half as many as outputs. For the others the reason for exclusion is given;
/// - specimens far from the others do not count in that choice;
/// - shapes of a table are outputs where its columns count modes as the model does.
///
/// Of a file with placeholders the study has a parameter each; command, output files and values are marked as unknown.
///
/// Nothing is written.
///
/// @throws InvalidInput, FormatError  a deck or tests that cannot be read, no output or parameter left
/// @throws SystemFailure              the modes do not converge
InitOutcome propose_study(const InitSettings& settings);

/// The tables of modes and parameters, and what to do next.
RunSummary summarise(const InitOutcome& outcome);

}  // namespace mottle::study
