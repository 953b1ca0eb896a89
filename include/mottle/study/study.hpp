// A study as the user wrote it: plain data, checked one by one, before any object is made from it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/core/options.hpp"
#include "mottle/fem/mass_spring.hpp"
#include "mottle/model/modal_model.hpp"
#include "mottle/stats/distribution.hpp"
#include "mottle/stats/sampling.hpp"

namespace mottle {

/// [model]: what kind, and what that kind needs.
struct StudyModelSource {
  enum class Kind { mass_spring, nastran };

  Kind kind = Kind::mass_spring;
  MassSpringSystem system = {};
  std::filesystem::path deck = {};          ///< resolved against the study's folder
  std::set<std::string> ignore_cards = {};  ///< in capitals
  bool may_reduce = true;                   ///< clouds by a reduced model where that pays
  double frequency_error = 1e-4;            ///< that a reduced model may make, relative
};

/// One [[parameter]].
struct StudyParameter {
  std::string name;
  std::vector<std::string> targets;
  bool is_factor = false;
  DistributionSpec distribution;
  double lower_bound = -std::numeric_limits<double>::infinity();
  double upper_bound = std::numeric_limits<double>::infinity();
};

/// Parameters with the correlation of their normal copula (identity where none is given).
struct StudyParameters {
  std::vector<StudyParameter> list;
  Eigen::MatrixXd correlation;
};

/// [test]
struct StudyTest {
  std::filesystem::path file;                   ///< resolved against the study's folder
  std::map<std::string, double> repeatability;  ///< standard deviation by output
  bool pairs_by_mac = false;                    ///< specimens' modes are renumbered by their shapes
};

/// [update]
struct StudyUpdate {
  std::string method = "mares";
  int samples = 1000;
  bool has_automatic_samples = false;
  SamplingDesign design = SamplingDesign::monte_carlo;
  int iterations = 30;
  double tolerance = 1e-3;
  double level = 0.05;
  double most_failed = 0.3;
  std::map<std::string, OptionValues> method_options;  ///< by method; those not chosen are checked but not used
};

/// [truth]: what `simulate` draws specimens from.
struct StudyTruth {
  int specimens = 10;
  StudyParameters parameters;
  std::map<std::string, double> noise;  ///< standard deviation of the measurement by output
};

/// The whole study.
struct Study {
  std::filesystem::path file;
  std::string title;
  std::string units = "SI";
  std::uint64_t seed = 1;
  StudyModelSource model;
  StudyParameters parameters;  ///< empty in a study that only holds a truth
  ModalOutputs outputs;
  std::optional<StudyTest> test;
  StudyUpdate update;
  std::optional<StudyTruth> truth;
  std::string text;  ///< the study as run, overrides applied, as TOML
  /// Line of what a message may start with: "outputs.frequencies", "parameter 'k1'", "truth.parameter 'k1'".
  std::map<std::string, int> lines;
};

/// What the command line adds to a study.
struct StudyOverrides {
  std::vector<std::string> assignments;  ///< "dotted.key=value"
  std::optional<std::uint64_t> seed;
};

/// Reads and checks a study file.
///
/// @throws InvalidInput  (file, line, key, value found, what is allowed): TOML that cannot be read, unknown keys with
///                       the nearest known one, wrong types, values out of range, an override that fits nothing
Study read_study(const std::filesystem::path& file, const StudyOverrides& overrides);

/// `message` with the study file in front, and the line of what the message starts with ("outputs.frequencies: ...").
///
/// @param section  put before the message to look its line up: "truth." for a parameter of the truth
std::string located(const Study& study, const std::string& message, const std::string& section = "");

/// The study's text for a file in `folder`: relative paths are rewritten to hold from there.
std::string study_text_for(const Study& study, const std::filesystem::path& folder);

}  // namespace mottle
