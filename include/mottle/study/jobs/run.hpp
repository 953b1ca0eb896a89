// Settings and summary that all jobs have in common: each job is a function from a study to an outcome; write_results()
// writes the outcome into a folder, summarise() puts it into words.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/run_settings.hpp"

namespace mottle::study {

/// Summary of a job; everything else is in its folder.
struct RunSummary {
  std::string status;
  std::string message = {};
  std::vector<std::string> lines = {};  ///< for a person
  std::string json = {};                ///< for a machine: one line
};

}  // namespace mottle::study
