#include "mottle/drivers/scheduler/run_place.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "mottle/core/error.hpp"

namespace mottle::drivers {

SharedRunPlace::SharedRunPlace(const SolverCommand& command, const RunStorage& storage)
    : storage_(storage), is_temporary_(command.scheduler && storage.results.empty()) {
  if (command.scheduler) {
    require(
        storage.ranks == nullptr,
        "model.launch: the runs are done by tasks of {}, which {} ranks would not share; start Mottle once, without "
        "mpirun or srun",
        scheduler_name(command.scheduler->kind), storage.ranks == nullptr ? 1 : storage.ranks->count());
  }
  if (!is_temporary_) return;
  std::string pattern = (std::filesystem::current_path() / "mottle-tasks-XXXXXX").string();
  const bool is_made = ::mkdtemp(pattern.data()) != nullptr;
  require(is_made, "{}: cannot be made: {}; tasks of a scheduler need a folder that all nodes see: start Mottle in one",
          pattern, std::strerror(errno));
  storage_.results = pattern;
}

SharedRunPlace::~SharedRunPlace() {
  std::error_code ignored;
  if (is_temporary_) std::filesystem::remove_all(storage_.results, ignored);
}

std::unique_ptr<ScheduledRuns> scheduled_runs(SolverRuns& runs, const SharedRunPlace& place,
                                              const std::atomic<bool>* stop) {
  const std::optional<SchedulerOptions>& options = runs.command().scheduler;
  if (!options) return nullptr;
  return std::make_unique<ScheduledRuns>(runs,
                                         TaskPlace{.results = place.storage().results,
                                                   .is_temporary = place.is_temporary(),
                                                   .is_resumed = place.storage().is_resumed},
                                         make_scheduler(*options, stop));
}

}  // namespace mottle::drivers
