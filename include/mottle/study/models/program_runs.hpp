// Models each of whose solutions is a run of a program.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::study {

struct ProgramRuns {
  double seconds_at_means = 0.0;  ///< of the run at the parameters' means; 0: its result was there from a run before
  int max_parallel = 1;           ///< most runs at a time
};

}  // namespace mottle::study
