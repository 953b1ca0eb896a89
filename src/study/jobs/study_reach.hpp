// Programs and files that a study uses outside its own folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/check.hpp"

namespace mottle::study {

/// A file that a study names, and under which key.
struct StudyFile {
  std::string key;
  std::filesystem::path file;
};

/// Model, tests and held-out tests; what is named where they cannot be listed.
std::vector<StudyFile> files_of(const Study& study);
/// The same without their keys, and the study itself.
std::vector<std::filesystem::path> paths_of(const Study& study);

/// @param read  files that the model was read from beside those that the study names (includes of a deck)
StudyReach reach_of(const Study& study, const std::vector<std::string>& read = {});

/// Sentences; none where the study stays within its folder and runs nothing.
std::vector<std::string> reach_lines(const StudyReach& reach);

}  // namespace mottle::study
