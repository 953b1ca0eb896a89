// Which bytes a study, its model and its tests were read from, so that a later job, or a reader, can tell whether they
// have changed.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// A file that was read.
struct ModelFile {
  std::string name;    ///< of a model relative to the folder of the first file that [model] names, else to the study
  std::string digest;  ///< of its bytes, 32 hexadecimal digits
};

/// @param files  of StudyModel::files
/// @throws InvalidInput  a file cannot be read
std::vector<ModelFile> digest_model_files(const Study& study, const std::vector<std::string>& files);

/// The study's file, then those of its tests; empty: a program gave them.
///
/// @throws InvalidInput  a file cannot be read
std::vector<ModelFile> digest_study_files(const Study& study);

Json model_files_json(const std::vector<ModelFile>& files);

/// What has happened to the files of an update's model since: "airframe.bdf has changed", "mesh.bdf is missing"; empty:
/// they are the same, or the result is of a version that did not record them.
///
/// @param study  the update's, as it stands among its results
std::vector<std::string> changes_of_model_files(const Study& study, const Json& result);

}  // namespace mottle::study
