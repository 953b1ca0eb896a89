#include "mottle/drivers/scheduler/scheduled_runs.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <thread>
#include <utility>

#include "drivers/command/run_output.hpp"
#include "drivers/scheduler/death_charges.hpp"
#include "drivers/scheduler/scheduled_batch.hpp"
#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/scheduler/task_worker.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

/// A network file system that is out of reach for a moment says no, and is asked again.
bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

/// The folder that a killed task was working in last; empty: it left none.
fs::path abandoned_run(const fs::path& task) {
  fs::path newest;
  fs::file_time_type time = fs::file_time_type::min();
  std::error_code ignored;
  fs::directory_iterator group(task / "runs", ignored);
  for (; group != fs::directory_iterator(); group.increment(ignored)) {
    fs::directory_iterator run(group->path(), ignored);
    for (; run != fs::directory_iterator(); run.increment(ignored)) {
      if (!run->path().filename().string().starts_with("run-") || run->last_write_time(ignored) < time) continue;
      newest = run->path();
      time = run->last_write_time(ignored);
    }
  }
  return newest;
}

/// Where a run's folder is within a task's; empty: it was not kept.
fs::path kept_run(const fs::path& task, const RunRecord& record, const std::string& id) {
  std::error_code ignored;
  const fs::path folder = task / (record.failure.empty() ? "kept-runs" : "failed-runs") / id;
  return fs::is_directory(folder, ignored) ? folder : fs::path();
}

}  // namespace

void ScheduledRuns::run_all(const Eigen::Ref<const Eigen::MatrixXd>& samples, int min_modes, const RunContext& context,
                            const Deliver& deliver) {
  Batch batch{samples, min_modes, context, deliver, RunQueue(options_)};
  if (has_log_) {
    for (const std::string& text : std::exchange(notes_, {})) context.note(text);
    for (const std::string& text : std::exchange(warnings_, {})) context.warning(text);
  }
  try {
    begin_batch(batch);
    while (!batch.queue.empty()) go_on(batch);
  } catch (const Stopped& why) {
    stop(why.what());
  }
  context.detail("");
  charges_->clear();
  clean();
}

/// Runs that are there are delivered at once.
void ScheduledRuns::begin_batch(Batch& batch) {
  for (Eigen::Index s = 0; s < batch.samples.rows(); ++s) {
    batch.context.throw_if_stopped();
    try {
      const Digest key = runs_.key_at(batch.samples.row(s).transpose(), batch.min_modes);
      std::optional<RunRecord> known = runs_.find(key);
      if (known) {
        batch.deliver(s, {.record = std::move(*known), .is_reused = true});
      } else {
        batch.queue.add(key, s, charges_->of(key));
      }
    } catch (const FormatError& error) {  // a value that does not fit into its placeholder
      batch.deliver(s, {.record = {.failure = error.what()}});
    }
  }
  for (const std::unique_ptr<TaskArray>& array : arrays_) {
    array->for_each_awaited([&](const Digest& key) { batch.queue.is_awaited(key); });
  }
}

/// One look at everything.
void ScheduledRuns::go_on(Batch& batch) {
  constexpr double k_idle_part = 10.0;  // looking takes a tenth of the time at most
  constexpr double k_longest_pause_s = 5.0;
  const double begin = steady_seconds();
  if (is_there(cancel_mark(results_))) throw Stopped("stopped by 'mottle cancel'");
  submit_more(batch);
  for (const std::unique_ptr<TaskArray>& array : arrays_) {
    if (!array->is_submitted && array->unfinished() > 0) submit(*array, batch);
  }
  ask(batch.context);
  read_stores(batch);
  for (const std::unique_ptr<TaskArray>& array : arrays_) {
    for (const TaskDeath& death : array->find_deaths(steady_seconds(), patience_)) bury(batch, *array, death);
  }
  clean();
  show_tasks(batch.context);
  if (batch.queue.empty()) return;
  const double took = steady_seconds() - begin;
  wait_a_moment(batch.context, std::clamp(k_idle_part * took, patience_.poll, k_longest_pause_s));
}

void ScheduledRuns::read_stores(Batch& batch) {
  for (const std::unique_ptr<TaskArray>& array : arrays_) {
    array->read_new([&](const Digest& key, std::string_view record, int task) {
      if (batch.queue.wants(key)) return finish_run(batch, key, decode_run(record), task_folder(array->folder(), task));
      keep_unasked(key, record);
    });
  }
}

void ScheduledRuns::keep_unasked(const Digest& key, std::string_view record) {
  if (!runs_.find(key)) runs_.keep(key, decode_run(record));
}

void ScheduledRuns::finish_run(Batch& batch, const Digest& key, RunRecord record, const fs::path& task) {
  SolverRuns::Run run{.record = std::move(record), .tries = 1};
  const std::string id = SolverRuns::id_of(key);
  fs::path folder = kept_run(task, run.record, id);
  if (!folder.empty()) run.folder = runs_.keep_folder(folder, !run.record.failure.empty(), id);
  if (!run.record.failure.empty() && !run.folder.empty()) run.last_words = printable(last_words(run.folder));
  runs_.keep(key, run.record);
  charges_->set(key, 0);
  for (const Eigen::Index sample : batch.queue.take(key)) batch.deliver(sample, run);
}

void ScheduledRuns::bury(Batch& batch, const TaskArray& array, const TaskDeath& death) {
  const fs::path task = task_folder(array.folder(), death.task);
  if (is_there(array.folder() / k_changed_files)) {
    throw InvalidInput(
        "the files of its model have changed since runs of it were submitted; start the job again for the files as "
        "they are now");
  }
  note(batch.context, fmt::format("task {} of {} ended with {} runs to do: {}", death.task, array.name(),
                                  death.missing.size(), death.reason));
  runs_.require_room(task);  // else a full disk would fail one run after the other
  const std::optional<RunQueue::Failure> failure = batch.queue.put_back(death);
  const Digest& first = death.missing.front();
  if (!failure) return charges_->set(first, batch.queue.deaths_of(first));
  if (!failure->is_begun && death.is_disk_full) {
    throw NoRoom(
        fmt::format("the disk was full again and again while runs were at work, the last: {}; these runs are "
                    "not failures of the model: make room and go on with --resume",
                    death.reason));
  }
  if (!failure->is_begun) {
    throw SystemFailure(
        fmt::format("tasks end again and again before they begin with a run, the last: {}; what it "
                    "printed is in {}",
                    death.reason, (task / "output.txt").string()));
  }
  const fs::path left = abandoned_run(task);
  const fs::path kept = left.empty() ? fs::path() : runs_.keep_folder(left, true, SolverRuns::id_of(failure->key));
  const SolverRuns::Run run{.record = {.failure = failure->text}, .tries = options_.tries, .folder = kept};
  runs_.keep(failure->key, run.record);
  charges_->set(failure->key, 0);
  for (const Eigen::Index sample : batch.queue.take(failure->key)) batch.deliver(sample, run);
}

void ScheduledRuns::note(const RunContext& context, const std::string& text) {
  if (has_log_) return context.note(text);
  notes_.push_back(text);
}

void ScheduledRuns::wait_a_moment(const RunContext& context, double seconds) {
  const double end = steady_seconds() + seconds;
  do {
    context.throw_if_stopped();
    std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(end - steady_seconds(), 0.0, 0.05)));
  } while (steady_seconds() < end);
}

void ScheduledRuns::stop(const std::string& why) {
  const int tasks = unfinished();
  leaves_tasks_ = !is_temporary_;
  if (is_there(cancel_mark(results_))) {  // also what was submitted meanwhile
    for (const std::unique_ptr<TaskArray>& array : arrays_) scheduler_->cancel(array->name());
    throw Stopped(why);
  }
  if (is_temporary_ || tasks == 0) throw Stopped(why);
  const std::string folder = results_.string();
  throw Stopped(fmt::format("{}; {} {} in {}: 'mottle status {}' shows them, 'mottle cancel {}' ends them", why, tasks,
                            tasks == 1 ? "task goes on" : "tasks go on", scheduler_name(options_.kind), folder,
                            folder));
}

int ScheduledRuns::unfinished() const {
  return std::accumulate(arrays_.begin(), arrays_.end(), 0,
                         [](int sum, const auto& array) { return sum + array->unfinished(); });
}

void ScheduledRuns::show_tasks(const RunContext& context) const {
  const int running = std::accumulate(arrays_.begin(), arrays_.end(), 0,
                                      [](int sum, const auto& array) { return sum + array->running(); });
  context.detail(fmt::format("{} tasks running, {} waiting", running, unfinished() - running));
}

}  // namespace mottle::drivers
