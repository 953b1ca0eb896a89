// What has become of a folder's tasks, seen from outside: with or without the Mottle that waits for them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mottle/drivers/scheduler/scheduler.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

struct ArrayStatus {
  std::string name = {};
  std::string job = {};  ///< the scheduler's number of it; empty: not known
  SchedulerKind kind = SchedulerKind::slurm;
  int tasks = 0;
  int waiting = 0, running = 0, ended = 0;  ///< of the tasks, as the scheduler says
  std::size_t runs = 0;
  std::size_t done = 0;                  ///< of the runs
  std::size_t failed = 0;                ///< of those done
  std::vector<TaskReport> reports = {};  ///< of the scheduler
  std::string silence = {};              ///< why the scheduler said nothing; empty: it has answered
};

/// All arrays within a folder of results. A scheduler that does not answer is no error. Throws SystemFailure where a
/// file is damaged.
std::vector<ArrayStatus> read_task_status(const std::filesystem::path& results);

/// Runs that a folder's store holds; 0 where there is none.
struct StoredRuns {
  std::size_t done = 0;
  std::size_t failed = 0;  ///< of those done
};
StoredRuns count_stored_runs(const std::filesystem::path& store);

/// Tells a Mottle that waits for the tasks to stop, and ends them.
///
/// @return  the names of the arrays that were cancelled
/// @throws  SystemFailure  the scheduler does not answer, or refuses
std::vector<std::string> cancel_tasks(const std::filesystem::path& results);

}  // namespace mottle::drivers
