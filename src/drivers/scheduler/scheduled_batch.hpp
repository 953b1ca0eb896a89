// A batch of runs that ScheduledRuns is at.
#pragma once

#include "mottle/drivers/scheduler/scheduled_runs.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

struct ScheduledRuns::Batch {
  const Eigen::Ref<const Eigen::MatrixXd>& samples;
  int min_modes;
  const RunContext& context;
  const Deliver& deliver;
  RunQueue queue;
};

}  // namespace mottle::drivers
