// The arrays of ScheduledRuns: made, submitted, asked for, found again, and taken away.
#include <algorithm>

#include "drivers/scheduler/death_charges.hpp"
#include "drivers/scheduler/left_arrays.hpp"
#include "drivers/scheduler/scheduled_batch.hpp"
#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/idle_memory.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/run_store.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

/// What tells tasks of two submissions apart, as `partition = "short"`.
std::vector<std::string> option_texts(const SchedulerOptions& options) {
  return {
      fmt::format("partition = \"{}\"", options.partition), fmt::format("time = \"{} s\"", options.time.count() / 1000),
      fmt::format("account = \"{}\"", options.account),     fmt::format("cores = {}", options.cores),
      fmt::format("licences = \"{}\"", options.licences),   fmt::format("extra = [{}]", join(options.extra, ", "))};
}

}  // namespace

ScheduledRuns::ScheduledRuns(SolverRuns& runs, const TaskPlace& place, std::unique_ptr<Scheduler> scheduler,
                             const TaskPatience& patience)
    : runs_(runs),
      results_(fs::absolute(place.results)),
      scheduler_(std::move(scheduler)),
      options_(*runs.command().scheduler),
      patience_(patience),
      question_interval_(patience.first_question),
      is_temporary_(place.is_temporary) {
  require_no_other_arrays(runs_, results_, place.is_resumed, options_.kind);
  std::error_code ignored;
  fs::remove(cancel_mark(results_), ignored);
  charges_ = std::make_unique<DeathCharges>(results_, place.is_resumed);
  adopt(place.is_resumed);
  fs::remove(results_ / k_task_folder, ignored);  // where it is empty
  release_idle_memory();
}

ScheduledRuns::~ScheduledRuns() {
  if (leaves_tasks_) return;
  try {
    // The last task of a batch is about to say that it is at its end.
    constexpr double k_patience_s = 3.0;
    const double end = steady_seconds() + k_patience_s;
    for (clean(); unfinished() == 0 && !arrays_.empty() && steady_seconds() < end; clean()) wait_a_moment({}, 0.05);
    for (const std::unique_ptr<TaskArray>& array : arrays_) discard(*array);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): a later Mottle finds what is left
  }
}

void ScheduledRuns::adopt(bool is_resumed) {
  for (const fs::path& folder : array_folders(results_)) {
    const std::optional<ArrayPlan> plan = read_array(folder);
    if (!plan) {  // a kill while it was made: nobody can have submitted it
      remove_array(folder);
      continue;
    }
    auto array = std::make_unique<TaskArray>(folder, *plan);
    const std::size_t found = take_over(runs_, *array, is_resumed);
    if (is_copied_array(folder, *plan)) {
      notes_.push_back(fmt::format("{}: a copy of another folder's tasks, which are left to it", array->name()));
      remove_array(folder);
      continue;
    }
    if (plan->constants != runs_.constants()) {
      notes_.push_back(fmt::format("{}: tasks of another study, or of other files, are ended", array->name()));
      scheduler_->cancel(array->name());
      remove_array(folder);
      continue;
    }
    array->limit = plan->command.scheduler->runs_at_once;
    array->is_asked = true;
    array->is_submitted = read_array_job(folder).has_value();
    notes_.push_back(fmt::format("{}: an earlier Mottle has left it; {} runs are there, {} tasks are not at their end",
                                 array->name(), found, array->unfinished()));
    if (array->unfinished() > 0) warn_of_old_options(*array, *plan->command.scheduler);
    seconds_a_run_ = std::max(seconds_a_run_, array->seconds_a_run());
    arrays_.push_back(std::move(array));
  }
}

void ScheduledRuns::warn_of_old_options(const TaskArray& array, const SchedulerOptions& old) {
  const std::vector<std::string> before = option_texts(old);
  const std::vector<std::string> now = option_texts(options_);
  std::vector<std::string> differences;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (before[i] != now[i]) differences.push_back(fmt::format("{}, now {}", before[i], now[i]));
  }
  if (differences.empty()) return;
  warnings_.push_back(
      fmt::format("{}: {} tasks were submitted before model.scheduler was changed ({}) and keep the old options; to "
                  "submit them anew, end them by 'mottle cancel {}' and start again",
                  array.name(), array.unfinished(), join(differences, "; "), results_.string()));
}

int ScheduledRuns::free_limit() const {
  if (options_.runs_at_once == 0) return 0;
  int used = 0;
  for (const std::unique_ptr<TaskArray>& array : arrays_) used += std::min(array->limit, array->unfinished());
  return options_.runs_at_once - used;
}

/// Few arrays of many tasks each: the next is made once half of what may wait is done.
void ScheduledRuns::submit_more(Batch& batch) {
  const int limit = free_limit();
  const int tasks = unfinished();
  if (batch.queue.to_submit() == 0 || tasks > k_most_tasks / 2 || (options_.runs_at_once > 0 && limit <= 0)) return;
  RunQueue::Next next = batch.queue.next(k_most_tasks - tasks, seconds_a_run_);
  if (next.keys.empty()) return;
  make_array(batch, std::move(next), limit);
  release_idle_memory();  // what has just been written was as large as all that is kept of it
}

void ScheduledRuns::make_array(Batch& batch, RunQueue::Next next, int limit) {
  ArrayPlan plan{.name = new_array_name(),
                 .command = runs_.frozen_command(),
                 .parameters = runs_.parameter_names(),
                 .min_modes = batch.min_modes,
                 .constants = runs_.constants(),
                 .keys = std::move(next.keys),
                 .values = batch.samples(next.samples, Eigen::all),
                 .ends = next.ends};
  plan.command.scheduler->runs_at_once = limit;
  const fs::path folder = results_ / k_task_folder / plan.name;
  write_array(folder, plan, scheduler_->number_variable());
  auto array = std::make_unique<TaskArray>(folder, plan);
  array->limit = limit;
  arrays_.push_back(std::move(array));
}

/// Where an earlier attempt got no answer, the scheduler may have the array: it is asked first.
void ScheduledRuns::submit(TaskArray& array, const RunContext& context) {
  if (steady_seconds() < array.next_try) return;
  try {
    if (array.is_asked && !scheduler_->list({array.name()}).empty()) {
      write_array_job(array.folder(), "");
    } else {
      array.is_asked = true;
      const std::string job = scheduler_->submit({.name = array.name(),
                                                  .script = array.folder() / "job.sh",
                                                  .folder = array.folder(),
                                                  .tasks = array.tasks(),
                                                  .limit = array.limit});
      write_array_job(array.folder(), job);
      note(context,
           fmt::format("{}: job {} of {}, {} tasks", array.name(), job, scheduler_name(options_.kind), array.tasks()));
    }
    array.is_submitted = true;
    is_silent_ = false;
    next_question_ = std::min(next_question_, steady_seconds()) + patience_.first_question;
  } catch (const SchedulerSilent& silence) {
    array.next_try = steady_seconds() + 2.0 * patience_.first_question;
    say_silence(context, silence.what());
  } catch (const SystemFailure&) {  // refused
    remove_array(array.folder());
    throw;
  }
}

void ScheduledRuns::ask(const RunContext& context) {
  const double now = steady_seconds();
  if (now < next_question_) return;
  std::vector<std::string> names;
  for (const std::unique_ptr<TaskArray>& array : arrays_) {
    if (array->is_submitted && array->unfinished() > 0) names.push_back(array->name());
  }
  if (names.empty()) return;
  bool has_changed = false;
  try {
    const std::vector<TaskReport> reports = scheduler_->list(names);
    for (const std::unique_ptr<TaskArray>& array : arrays_) {
      if (std::ranges::find(names, array->name()) == names.end()) continue;
      has_changed |= array->take(reports, steady_seconds());
    }
    look_for_missing(context);
    if (is_silent_) note(context, fmt::format("{} answers again", scheduler_name(options_.kind)));
    is_silent_ = false;
  } catch (const SchedulerSilent& silence) {
    say_silence(context, silence.what());
  }
  constexpr double k_growth = 1.5;
  question_interval_ =
      has_changed ? patience_.first_question : std::min(k_growth * question_interval_, patience_.last_question);
  next_question_ = steady_seconds() + question_interval_;
}

/// A list without a task is no proof that the task has ended.
void ScheduledRuns::look_for_missing(const RunContext& context) {
  for (const std::unique_ptr<TaskArray>& array : arrays_) {
    const int missing = array->missing();
    if (missing == 0) continue;
    const std::string job = read_array_job(array->folder()).value_or("");
    array->take_found(scheduler_->look_up(array->name(), job), steady_seconds());
    if (array->missing() == 0 || std::exchange(array->is_missing_told, true)) continue;
    note(context,
         fmt::format("{}: {} does not list {} of its tasks; they are given up once they have given no sign of "
                     "life for {:.0f} s",
                     array->name(), scheduler_name(options_.kind), array->missing(), 2.0 * patience_.after_silence));
  }
}

void ScheduledRuns::say_silence(const RunContext& context, const std::string& words) {
  if (!is_silent_) context.warning(fmt::format("{}; it is asked again until it answers", words));
  is_silent_ = true;
}

/// Arrays whose tasks are all at their end go.
void ScheduledRuns::clean() {
  std::erase_if(arrays_, [&](const std::unique_ptr<TaskArray>& array) {
    if (array->unfinished() > 0 || !array->is_left()) return false;
    if (const double seconds = array->seconds_a_run(); seconds > 0.0) seconds_a_run_ = seconds;
    runs_.flush();
    remove_array(array->folder());
    return true;
  });
}

void ScheduledRuns::discard(TaskArray& array) {
  if (array.unfinished() > 0) scheduler_->cancel(array.name());
  array.read_new([&](const Digest& key, std::string_view record, int) { keep_unasked(key, record); });
  runs_.flush();
  remove_array(array.folder());
}

}  // namespace mottle::drivers
