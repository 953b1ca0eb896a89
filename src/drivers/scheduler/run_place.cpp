#include "mottle/drivers/scheduler/run_place.hpp"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include "drivers/scheduler/left_arrays.hpp"
#include "mottle/core/error.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/drivers/scheduler/task_status.hpp"

namespace mottle::drivers {
namespace {

constexpr const char* k_place_mark = ".mottle-tasks";  // only what holds it is ever removed

/// Of the folders that are made on this host.
std::string place_prefix() {
  return fmt::format("mottle-tasks-{}-", node_name());
}

/// Tasks that were cancelled may write until they have ended: by its path they find it no more, and what those write
/// that are inside is removed again. If they go on, the next Mottle removes the rest.
void remove_folder(std::filesystem::path place) {
  constexpr int k_attempts = 40;
  std::error_code error;
  std::filesystem::path moved = place;
  moved += "-removed";
  std::filesystem::rename(place, moved, error);
  if (!error) place = moved;
  for (int attempt = 0; attempt < k_attempts; ++attempt) {
    std::filesystem::remove_all(place, error);
    if (!std::filesystem::exists(place, error)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::ofstream(place / k_place_mark).close();
}

/// Where tasks are left that could not be ended, it stays, and the next Mottle ends them.
void remove_place(const std::filesystem::path& place) {
  if (array_folders(place).empty()) remove_folder(place);
}

/// Whether a process that made a folder is gone: "mottle-tasks-HOST-123-XXXXXX".
bool is_abandoned(const std::filesystem::path& place) {
  std::error_code ignored;
  return is_of_dead_process(place.filename().string(), place_prefix()) &&
         std::filesystem::symlink_status(place, ignored).type() == std::filesystem::file_type::directory &&
         std::filesystem::is_regular_file(place / k_place_mark, ignored);
}

/// Those of a Mottle that was killed, or stopped twice, before it had cancelled its tasks.
void end_abandoned_places(const std::filesystem::path& parent) {
  std::error_code ignored;
  std::filesystem::directory_iterator entry(parent, ignored);
  for (; entry != std::filesystem::directory_iterator(); entry.increment(ignored)) {
    if (!is_abandoned(entry->path())) continue;
    try {
      cancel_tasks(entry->path());
      remove_folder(entry->path());
    } catch (
        const Error&) {  // NOLINT(bugprone-empty-catch): the scheduler does not answer; the next Mottle tries again
    }
  }
}

}  // namespace

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
  const std::filesystem::path here = std::filesystem::current_path();
  end_abandoned_places(here);
  std::string pattern = (here / fmt::format("{}{}-XXXXXX", place_prefix(), ::getpid())).string();
  const bool is_made = ::mkdtemp(pattern.data()) != nullptr;
  require(is_made, "{}: cannot be made: {}; tasks of a scheduler need a folder that all nodes see: start Mottle in one",
          pattern, std::strerror(errno));
  storage_.results = pattern;
  write_run_file(storage_.results / k_place_mark, "Made by Mottle for one job, and removed by it.\n");
}

SharedRunPlace::~SharedRunPlace() {
  if (is_temporary_) remove_place(storage_.results);
}

std::unique_ptr<ScheduledRuns> scheduled_runs(SolverRuns& runs, const SharedRunPlace& place,
                                              const std::atomic<bool>* stop) {
  const std::optional<SchedulerOptions>& options = runs.command().scheduler;
  if (!options) {
    const RunStorage& storage = place.storage();
    const bool is_first = storage.ranks == nullptr || storage.ranks->is_first();
    if (!storage.results.empty() && !storage.is_task && is_first) {
      require_no_other_arrays(runs, std::filesystem::absolute(storage.results), storage.is_resumed, std::nullopt);
    }
    return nullptr;
  }
  return std::make_unique<ScheduledRuns>(runs,
                                         TaskPlace{.results = place.storage().results,
                                                   .is_temporary = place.is_temporary(),
                                                   .is_resumed = place.storage().is_resumed},
                                         make_scheduler(*options, stop));
}

}  // namespace mottle::drivers
