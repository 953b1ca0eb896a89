// What every job of a study is given and says: each is a function from a study to an outcome; write_results() leaves
// the outcome in a folder, summarise() puts it into words.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/run_settings.hpp"

namespace mottle::study {

/// What a job says at its end; everything else is in its folder.
struct RunSummary {
  std::string status;
  std::string message = {};
  std::vector<std::string> lines = {};  ///< for a person
  std::string json = {};                ///< for a machine: one line
};

}  // namespace mottle::study
