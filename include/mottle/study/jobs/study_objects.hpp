// Makes the objects of a study: model, parameter space, test data, method.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/jobs/study_model.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// What each parameter acts on.
std::vector<ParameterTargets> list_targets(const StudyParameters& parameters);

/// @param settings  folders of results and of what later runs may use again; without a folder of results, runs of a
///                  solver by command are kept nowhere
/// Throws InvalidInput: what the parameters name is not in the model, an output is not, a mean is impossible;
/// SystemFailure: a solver by command fails at the parameters' means.
StudyModel make_model(const Study& study, const StudyParameters& parameters, const RunSettings& settings = {});

struct PairedSpecimen;

/// Something in the tests that is probably mistaken, and is used as it is.
struct TestDoubt {
  std::string kind;  ///< as of causes[].kind of result.json, see docs/howto/report.md
  std::string sentence;
};

/// The tests of a study, columns in the order of the model's outputs.
struct StudyTests {
  TestData data;
  std::string file = {};           ///< that they were read from, the first of several
  std::vector<std::string> notes;  ///< columns and rows that were left out, and why
  std::vector<TestDoubt> doubts = {};
  std::string pairing = {};  ///< pairing.csv; empty where the tests came as a table of outputs
  bool is_by_rank = false;   ///< modes are numbered by rank of frequency, not by shape
  /// Modes as measured, with the model's mode of each; null where the tests came as a table of outputs.
  std::shared_ptr<const std::vector<PairedSpecimen>> specimens = nullptr;
};

/// Columns: output names, with or without a unit behind ("f1", "f1_Hz", "f1 [Hz]"). Columns of the study's parameters
/// (known truth), of outputs that the study does not use, and "specimen" or "status" are left out. A row without any
/// value is a specimen without data and is left out. Specimens are numbered by the rows of the file, empty ones
/// included, or by a column "specimen" of different whole numbers.
///
/// With test.pairing = "mac" the modes of every specimen are renumbered by their shapes, see pair_tests().
///
/// Repeatability from rules by name or pattern, or from a file of repeats: rows of one "specimen" are repeats of it
/// (all rows where there is no such column), and the standard deviation of an output is the root of the squares about
/// its specimens' means over their degrees of freedom.
///
/// Specimens may instead come as modes, one a file: universal files, or CSV tables with a column "dof". Their modes
/// become the outputs' values, see src/study/tests/pair_modes.hpp.
///
/// Throws FormatError, InvalidInput: no [test], a column that is nothing of these, an output without column, no row,
/// text where a number should be, repeatability of something that is not an output, an output that is never repeated.
StudyTests read_tests(const Study& study, const StructureModel& model);

/// UpdatingProblem::covariance_groups of the parameters `names`.
///
/// Throws InvalidInput: update.covariance names something that is not a parameter.
std::vector<int> covariance_groups(const Study& study, const std::vector<std::string>& names);

/// Whether the first and the last cloud have few samples, since the study states no number, each is a run of a program,
/// and the method does not depend on them.
bool shows_few_samples(const Study& study, const StudyModel& made);

/// Updating problem settings of a study with `specimens` tests ("auto" resolved).
CloudSettings cloud_settings(const Study& study, const StudyModel& made, Eigen::Index specimens, Eigen::Index outputs);

/// Of everything that the results depend on: study, overrides, tests, the model's files, points where given, version.
Digest study_fingerprint(const Study& study, const StudyModel& made,
                         const std::optional<std::filesystem::path>& points = std::nullopt);

/// Version of the program, as in CMakeLists.txt.
std::string version();

/// First digits of the commit that the program was built from; empty: not known.
std::string commit();

}  // namespace mottle::study
