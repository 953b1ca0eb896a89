// Models each of whose solutions is a run of a program.
#pragma once

#include <functional>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::study {

struct ProgramRuns {
  double seconds_at_means = 0.0;  ///< of the run at the parameters' means; 0: its result was there from a run before
  int max_parallel = 1;           ///< most runs at a time
  /// What is to be said of the runs once the job is done; it may be empty. As long as the model lives.
  std::function<std::string()> last_word = [] { return std::string(); };
};

}  // namespace mottle::study
