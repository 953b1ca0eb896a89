// Makes the objects of a study: model, parameter space, test data, method.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mottle/model/modal_model.hpp"
#include "mottle/model/parameter_space.hpp"
#include "mottle/study/study.hpp"
#include "mottle/updating/updater.hpp"

namespace mottle {

/// Parameters and the model that they drive.
struct StudyModel {
  std::unique_ptr<ParameterSpace> space;
  std::unique_ptr<ModalModel> model;
  std::vector<std::string> files = {};  ///< that the model was read from
  std::vector<std::string> notes = {};  ///< what a reader of the model should know
};

/// Throws InvalidInput: what the parameters name is not in the model, an output is not, a mean is impossible.
StudyModel make_model(const Study& study, const StudyParameters& parameters);

/// The tests of a study, columns in the order of the model's outputs.
struct StudyTests {
  TestData data;
  std::vector<std::string> notes;  ///< columns and rows that were left out, and why
};

/// Columns: output names, with or without a unit behind ("f1", "f1_Hz", "f1 [Hz]"). Columns of the study's parameters
/// (known truth), of outputs that the study does not use, and "specimen" or "status" are left out. A row without any
/// value is a specimen without data and is left out.
///
/// With test.pairing = "mac" the modes of every specimen are renumbered by their shapes, see pair_tests().
///
/// Throws FormatError, InvalidInput: no [test], a column that is nothing of these, an output without column, no row,
/// text where a number should be, repeatability of something that is not an output.
StudyTests read_tests(const Study& study, const ModalModel& model);

/// Updating problem settings of a study with `specimens` tests ("auto" resolved).
CloudSettings cloud_settings(const Study& study, Eigen::Index specimens, Eigen::Index outputs);

/// Of everything that the results depend on: study, overrides, tests, the model's files, version.
std::uint64_t study_fingerprint(const Study& study, const StudyModel& made);

/// Version of the program, as in CMakeLists.txt.
std::string version();

}  // namespace mottle
