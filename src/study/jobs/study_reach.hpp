// What a study reaches beyond its own folder, for whoever is handed a study by a stranger: the programs that it runs
// and the files that lie elsewhere.
#pragma once

#include <string>
#include <vector>

#include "mottle/study/input/study.hpp"

namespace mottle {

struct StudyReach {
  std::vector<std::string> programs;  ///< "model.command: python3 solver.py"
  std::vector<std::string> outside;   ///< "test.file: /data/tests.csv", links followed
};

/// @param read  files that the model was read from beside those that the study names (includes of a deck)
StudyReach reach_of(const Study& study, const std::vector<std::string>& read = {});

/// Sentences; none where the study stays within its folder and runs nothing.
std::vector<std::string> reach_lines(const StudyReach& reach);

}  // namespace mottle
