// Where tasks of a scheduler find their runs.
#pragma once

#include <atomic>
#include <memory>

#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/scheduler/scheduled_runs.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Where tasks of a scheduler find their runs: the folder of results, or where there is none a folder within the
/// present one, which goes again: nodes of a cluster do not see each other's temporary files.
class SharedRunPlace {
 public:
  SharedRunPlace(const SolverCommand& command, const RunStorage& storage);
  ~SharedRunPlace();
  SharedRunPlace(const SharedRunPlace&) = delete;
  SharedRunPlace& operator=(const SharedRunPlace&) = delete;

  const RunStorage& storage() const { return storage_; }
  bool is_temporary() const { return is_temporary_; }

 private:
  RunStorage storage_;
  bool is_temporary_ = false;
};

/// Null where this machine does the runs.
std::unique_ptr<ScheduledRuns> scheduled_runs(SolverRuns& runs, const SharedRunPlace& place,
                                              const std::atomic<bool>* stop);

}  // namespace mottle::drivers
