#include "drivers/scheduler/left_arrays.hpp"

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/drivers/command/run_store.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

/// As a study writes it.
const char* launch_word(std::optional<SchedulerKind> kind) {
  if (!kind) return "local";
  return *kind == SchedulerKind::slurm ? "slurm" : *kind == SchedulerKind::pbs ? "pbs" : "lsf";
}

bool has_task_at_work(const fs::path& folder, int tasks) {
  for (int task = 1; task <= tasks; ++task) {
    if (is_store_held(task_folder(folder, task) / k_run_store)) return true;
  }
  return false;
}

}  // namespace

std::size_t take_over(SolverRuns& runs, TaskArray& array, bool is_resumed) {
  const std::size_t found = array.read_new([&](const Digest& key, std::string_view bytes, int) {
    const RunRecord record = decode_run(bytes);
    if ((record.failure.empty() || is_resumed) && !runs.find(key)) runs.keep(key, record);
  });
  runs.flush();
  return found;
}

void require_no_other_arrays(SolverRuns& runs, const fs::path& results, bool is_resumed,
                             std::optional<SchedulerKind> kind) {
  std::error_code ignored;
  const bool is_cancelled = fs::exists(cancel_mark(results), ignored);
  std::vector<std::string> left;
  std::string launch;
  for (const fs::path& folder : array_folders(results)) {
    const std::optional<ArrayPlan> plan = read_array(folder);
    if (plan && plan->command.scheduler && kind && plan->command.scheduler->kind == *kind) continue;
    if (plan && plan->command.scheduler && !is_copied_array(folder, *plan)) {
      TaskArray array(folder, *plan);
      take_over(runs, array, is_resumed);
      const bool may_go_on = is_cancelled ? has_task_at_work(folder, array.tasks()) : array.unfinished() > 0;
      if (may_go_on) {
        launch = launch_word(plan->command.scheduler->kind);
        left.push_back(fmt::format("{} ({}job {}, {} tasks that are not at their end)", array.name(),
                                   is_cancelled ? "cancelled, but not ended yet, " : "",
                                   read_array_job(folder).value_or("not known"), array.unfinished()));
        continue;
      }
    }
    remove_array(folder);
  }
  require(left.empty(),
          "model.launch: is \"{}\" now, and an earlier start has left tasks of \"{}\" in {}: {}; end them by 'mottle "
          "cancel {}', or set launch back to \"{}\"",
          launch_word(kind), launch, results.string(), join(left, "; "), results.string(), launch);
  if (kind) return;
  fs::remove(cancel_mark(results), ignored);
  fs::remove(results / k_task_folder, ignored);  // where it is empty
}

}  // namespace mottle::drivers
