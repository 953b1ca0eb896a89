#include "mottle/drivers/scheduler/task_worker.hpp"

#include "drivers/scheduler/heartbeat.hpp"
#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/solver_process.hpp"
#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/scheduler/array_folder.hpp"

namespace mottle::drivers {
namespace {

[[noreturn]] void refuse_changed_files(const std::filesystem::path& array) {
  const std::string text = "the study's files have changed since these runs were submitted";
  write_file_atomically(array / k_changed_files, text + "\n");
  throw InvalidInput(text);
}

/// Whether all of them are done.
bool do_runs(const ArrayPlan& plan, const std::filesystem::path& array, int task, const std::atomic<bool>* stop) {
  SolverCommand command = plan.command;
  command.scheduler.reset();  // here they are done
  const std::filesystem::path folder = task_folder(array, task);
  // Before the store is opened, which cuts off what looks torn: on another node, whose locks are not seen here, a run
  // may just be written to it.
  const std::unique_ptr<Heartbeat> heartbeat = Heartbeat::begin(folder);
  if (!heartbeat) return false;
  SolverRuns runs(std::move(command), plan.parameters, {.results = folder, .is_resumed = true, .is_task = true});
  if (runs.constants() != plan.constants) refuse_changed_files(array);
  const ProcessSeries series;
  for (std::size_t run = plan.begin_of(task); run < plan.end_of(task); ++run) {
    if (is_given_up(folder)) return false;
    const Eigen::VectorXd values = plan.values.row(static_cast<Eigen::Index>(run)).transpose();
    if (runs.key_at(values, plan.min_modes) != plan.keys[run]) refuse_changed_files(array);
    if (stop != nullptr && stop->load()) throw Stopped("stopped on request");
    runs.run(values, plan.min_modes, stop);
  }
  return true;
}

/// A full disk is the word of nobody's run; where not even this can be said, the death is charged.
void say_full_disk(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::create_directory(folder / k_full_disk, ignored);
}

}  // namespace

void run_task(const std::filesystem::path& array, int task, const std::atomic<bool>* stop) {
  const std::optional<ArrayPlan> plan = read_array(array);
  require(plan.has_value(), "{}: holds no array of tasks; 'mottle run-task' is for the scripts that Mottle submits",
          array.string());
  require(task >= 1 && task <= plan->tasks(), "{}: has tasks 1 to {}, there is no task {}", array.string(),
          plan->tasks(), task);
  const double begin = steady_seconds();
  std::filesystem::remove(task_folder(array, task) / k_full_disk);
  try {
    if (!do_runs(*plan, array, task, stop)) return;
  } catch (const NoRoom&) {
    say_full_disk(task_folder(array, task));
    throw;
  }
  write_task_end(array, task,
                 {.runs = plan->end_of(task) - plan->begin_of(task),
                  .bytes = std::filesystem::file_size(task_folder(array, task) / k_run_store),
                  .seconds = steady_seconds() - begin});
}

}  // namespace mottle::drivers
