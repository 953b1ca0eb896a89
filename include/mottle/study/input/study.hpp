// A study as the user wrote it: plain data, checked one by one, before any object is made from it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/options.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/responses/output_selection.hpp"
#include "mottle/stats/distributions/distribution.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"
#include "mottle/stats/sampling/sampling.hpp"
#include "mottle/updating/methods/surrogate_settings.hpp"

namespace mottle::study {

class ModelSource;
struct TestContents;

/// One [[parameter]].
struct StudyParameter {
  std::string name;
  std::vector<std::string> targets;
  bool is_factor = false;
  DistributionSpec distribution;
  double lower_bound = -std::numeric_limits<double>::infinity();
  double upper_bound = std::numeric_limits<double>::infinity();
  ParameterTransform transform = {};  ///< under which its population is normal
  bool may_vanish = false;  ///< its value may be zero where a stiffness must be positive else: a spring not there yet
};

/// Parameters with the correlation of their normal copula (identity where none is given).
struct StudyParameters {
  std::vector<StudyParameter> list;
  Eigen::MatrixXd correlation;
};

/// Measurement noise of the outputs whose names fit a pattern.
struct NoiseRule {
  std::string pattern;
  double value = 0.0;  ///< standard deviation in the output's unit, or as a fraction of its mean
  bool is_relative = false;
};

/// The way in which the tests' modes get the model's numbers.
enum class TestPairing {
  order,      ///< as they are numbered
  mac,        ///< by their shapes
  named,      ///< columns of a table are the model's modes, told apart before
  frequency,  ///< columns of a table, by frequency in ascending order
};

/// [test]
struct StudyTest {
  std::string key = "test.file";              ///< that names the files, for messages
  std::vector<std::filesystem::path> files;   ///< files, folders or patterns, resolved against the study's folder
  std::vector<NoiseRule> repeatability = {};  ///< in the order of the file
  std::optional<std::filesystem::path> repeats_file = std::nullopt;  ///< repeated tests, in place of the rules
  std::vector<NoiseRule> model_error = {};            ///< of an error of the model, shared by all specimens
  bool is_model_error_estimated = false;              ///< its level is estimated, there are no rules then
  std::optional<TestPairing> pairing = std::nullopt;  ///< not given: `mac` of tests that come as modes, else `order`
  std::vector<int> left_out = {};                     ///< numbers of specimens that are not used
  std::shared_ptr<const TestContents> contents = nullptr;  ///< of the files, where the study could not be read without
};

/// [update]
struct StudyUpdate {
  std::string method = "maximum-likelihood";
  int samples = 1000;
  bool states_samples = false;
  bool has_automatic_samples = false;
  SamplingDesign design = SamplingDesign::monte_carlo;
  int iterations = 30;
  double tolerance = 1e-3;
  double level = 0.05;
  double max_failed = 0.3;
  std::optional<int> starts = std::nullopt;  ///< of the search for all solutions; not given: none by runs of a program
  bool is_diagonal = false;                  ///< no two parameters are correlated in the population
  /// Parameters that may be correlated with each other, those not named each alone; empty: all with all.
  std::vector<std::vector<std::string>> covariance_groups = {};
  std::map<std::string, OptionValues> method_options;  ///< by method; those not chosen are checked but not used
};

/// [truth]: what `simulate` draws specimens from.
struct StudyTruth {
  int specimens = 10;
  StudyParameters parameters;
  std::vector<NoiseRule> noise = {};  ///< of the measurement
};

/// [diagnose]: candidates for parameters that may be missing.
struct StudyDiagnose {
  std::vector<StudyParameter> candidates;  ///< without name and distribution where only a target is given; empty: all
  double spread = 0.2;                     ///< relative prior standard deviation of a candidate given by its target
  int screened = 12;
  double like_evidence = 6.0;
  int evidence = 0;  ///< how many of the best candidates are compared by the evidence of the models with them
};

/// [predict]: outputs that were not used, of the structure as it is or as it will be.
struct StudyPredict {
  OutputSelection outputs;
  std::map<std::string, double> overrides;      ///< numbers of the model that are other there, by target
  std::map<std::string, double> repeatability;  ///< by output; else that of the update's output of the same name
  std::optional<std::filesystem::path> held_out = std::nullopt;
  int draws = 4000;
};

/// The whole study.
struct Study {
  std::filesystem::path file;
  std::string title;
  std::string units = "SI";
  std::uint64_t seed = 1;
  std::shared_ptr<const ModelSource> model;  ///< [model]
  bool may_reduce = true;                    ///< clouds by a reduced model, where [model] allows it and it pays
  StudyParameters parameters;                ///< empty in a study that only holds a truth
  OutputSelection outputs;
  std::string outputs_key = "outputs";  ///< that names the outputs, for messages
  std::optional<StudyTest> test;
  StudyUpdate update;
  std::optional<StudyTruth> truth;
  StudyDiagnose diagnose;
  std::optional<StudyPredict> predict = std::nullopt;
  std::optional<SurrogateSettings> surrogate = std::nullopt;  ///< `update` works on a surrogate of the model
  std::string text;                                           ///< the study as run, overrides applied, as TOML
  /// Line of each key: "outputs.frequencies", "parameter 'k1'", "truth.parameter 'k1'".
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
Study read_study(const std::filesystem::path& file, const StudyOverrides& overrides = {});

/// The same of a study that is not in a file yet.
///
/// @param file  where it will be: paths are relative to its folder
Study read_study_text(const std::string& text, const std::filesystem::path& file);

/// "study.toml:12: outputs.frequencies: FAULT": the key's line, or that of the table that it would stand in.
///
/// @param section  prefix of the key in the table of lines: "truth." for a parameter of the truth
std::string located(const Study& study, const std::string& key, const std::string& fault,
                    const std::string& section = "");
/// The same of an error that says what it is about; of others the study's name alone is put in front.
std::string located(const Study& study, const InvalidInput& error, const std::string& section = "");

/// The study's text for a file in `folder`: relative paths are rewritten to hold from there.
std::string study_text_for(const Study& study, const std::filesystem::path& folder);

}  // namespace mottle::study
