// Arrays that an earlier Mottle has left in a folder of results for another scheduler than the one that is now to do
// the runs, or for one where now this machine does them.
#pragma once

#include <filesystem>
#include <optional>

#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/scheduler/task_array.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Keeps what an array's tasks have done; their number.
///
/// @param is_resumed  runs that failed count
std::size_t take_over(SolverRuns& runs, TaskArray& array, bool is_resumed);

/// Takes over what tasks of other schedulers have done, and takes away their arrays where they are done or cancelled.
///
/// @param kind  of the scheduler that does the runs now; nothing: this machine
/// @throws InvalidInput  tasks are left that may still do runs
void require_no_other_arrays(SolverRuns& runs, const std::filesystem::path& results, bool is_resumed,
                             std::optional<SchedulerKind> kind);

}  // namespace mottle::drivers
