#include "mottle/drivers/scheduler/task_status.hpp"

#include <algorithm>
#include <map>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/drivers/command/run_store.hpp"
#include "mottle/drivers/scheduler/array_folder.hpp"

namespace mottle::drivers {
namespace {

void ask_for_tasks(const SchedulerOptions& options, ArrayStatus& status) {
  try {
    status.reports = make_scheduler(options, nullptr)->list({status.name});
  } catch (const SystemFailure& error) {
    status.silence = error.what();
  }
  for (const TaskReport& report : status.reports) {
    if (report.state == TaskReport::State::waiting) ++status.waiting;
    if (report.state == TaskReport::State::running) ++status.running;
  }
  if (status.silence.empty()) status.ended = status.tasks - status.waiting - status.running;
}

}  // namespace

StoredRuns count_stored_runs(const std::filesystem::path& store) {
  // The last word on a run counts.
  std::map<Digest, bool> has_failed;
  read_run_records(store, 0, [&](const Digest& key, std::string_view record) {
    has_failed[key] = !decode_run(record).failure.empty();
  });
  StoredRuns runs{.done = has_failed.size()};
  for (const auto& [key, is_failure] : has_failed) runs.failed += is_failure ? 1 : 0;
  return runs;
}

std::vector<ArrayStatus> read_task_status(const std::filesystem::path& results) {
  std::vector<ArrayStatus> all;
  for (const std::filesystem::path& folder : array_folders(results)) {
    const std::optional<ArrayPlan> plan = read_array(folder);
    if (!plan || !plan->command.scheduler) continue;
    ArrayStatus status{.name = plan->name,
                       .job = read_array_job(folder).value_or(""),
                       .kind = plan->command.scheduler->kind,
                       .tasks = plan->tasks(),
                       .runs = plan->keys.size()};
    for (int task = 1; task <= plan->tasks(); ++task) {
      const StoredRuns runs = count_stored_runs(task_folder(folder, task) / k_run_store);
      status.done += runs.done;
      status.failed += runs.failed;
    }
    if (is_copied_array(folder, *plan)) {
      status.silence = "a copy: its tasks belong to the folder that it was copied from";
    } else {
      ask_for_tasks(*plan->command.scheduler, status);
    }
    all.push_back(std::move(status));
  }
  return all;
}

std::vector<std::string> cancel_tasks(const std::filesystem::path& results) {
  std::vector<std::string> names;
  const std::vector<std::filesystem::path> folders = array_folders(results);
  std::error_code ignored;
  if (!folders.empty() || std::filesystem::exists(results / k_run_store, ignored)) {
    std::filesystem::create_directory(results / k_task_folder, ignored);
    write_file_atomically(cancel_mark(results), "");  // for a Mottle that is between two batches too
  }
  for (const std::filesystem::path& folder : folders) {
    const std::optional<ArrayPlan> plan = read_array(folder);
    if (!plan || !plan->command.scheduler) continue;
    require(!is_copied_array(folder, *plan),
            "{}: is a copy of a folder of tasks, which belong to the folder that it was copied from; cancel them there",
            folder.string());
    make_scheduler(*plan->command.scheduler, nullptr)->cancel(plan->name);
    names.push_back(plan->name);
  }
  return names;
}

}  // namespace mottle::drivers
