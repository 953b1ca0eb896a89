#include "mottle/drivers/scheduler/task_array.hpp"

#include <algorithm>

#include "drivers/command/run_output.hpp"
#include "drivers/scheduler/heartbeat.hpp"
#include "drivers/scheduler/scheduler_call.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/drivers/command/run_store.hpp"
#include "mottle/drivers/scheduler/task_worker.hpp"

namespace mottle::drivers {
namespace {

constexpr int k_enough_absences = 2;

}  // namespace

TaskArray::TaskArray(std::filesystem::path folder, const ArrayPlan& plan)
    : folder_(std::move(folder)),
      name_(plan.name),
      constants_(plan.constants),
      keys_(plan.keys),
      is_seen_(plan.keys.size(), false) {
  for (int task = 1; task <= plan.tasks(); ++task) {
    const std::size_t first = plan.begin_of(task);
    const std::size_t end = plan.end_of(task);
    tasks_.push_back({.first = first, .end = end, .next = first, .left = end - first});
  }
}

/// Records come in the order of the runs, mostly.
bool TaskArray::note_key(Task& task, const Digest& key) {
  for (std::size_t run = task.next; run < task.end; ++run) {
    if (keys_[run] != key || is_seen_[run]) continue;
    is_seen_[run] = true;
    --task.left;
    while (task.next < task.end && is_seen_[task.next]) ++task.next;
    return true;
  }
  return false;
}

std::size_t TaskArray::read_new(const Visit& visit) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    Task& task = tasks_[i];
    if (task.is_over || task.left == 0) continue;
    const int number = static_cast<int>(i) + 1;
    task.bytes = read_run_records(task_folder(folder_, number) / k_run_store, task.bytes,
                                  [&](const Digest& key, std::string_view record) {
                                    if (!note_key(task, key)) return;
                                    ++found;
                                    visit(key, record, number);
                                  });
  }
  return found;
}

bool TaskArray::Task::is_missing() const {
  return !is_over && left > 0 && !is_ended() && absences >= k_enough_absences;
}

std::vector<const TaskReport*> TaskArray::by_task(const std::vector<TaskReport>& reports) const {
  std::vector<const TaskReport*> found(tasks_.size(), nullptr);
  for (const TaskReport& report : reports) {
    if (report.array != name_ || report.task < 1 || report.task > static_cast<int>(tasks_.size())) continue;
    const TaskReport*& best = found[static_cast<std::size_t>(report.task) - 1];
    // An array that was submitted twice, for want of an answer, is alive where one of the two is.
    if (best == nullptr || best->state == TaskReport::State::ended) best = &report;
  }
  return found;
}

void TaskArray::take_one(Task& task, int number, const TaskReport& report, double now) {
  const bool was_ended = task.is_ended();
  task.absences = 0;
  task.report = report;
  if (task.is_ended() && !was_ended) task.ended_at = now;
  if (task.is_given_up && !task.is_ended()) {
    take_up(task_folder(folder_, number));
    task.is_given_up = false;
  }
}

bool TaskArray::take(const std::vector<TaskReport>& reports, double now) {
  bool has_changed = false;
  const std::vector<const TaskReport*> found = by_task(reports);
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    Task& task = tasks_[i];
    if (task.is_over) continue;
    if (found[i] == nullptr) {
      if (++task.absences == k_enough_absences) task.missing_since = now;
      continue;
    }
    has_changed |= task.report.state != found[i]->state;
    take_one(task, static_cast<int>(i) + 1, *found[i], now);
  }
  return has_changed;
}

void TaskArray::take_found(const std::vector<TaskReport>& reports, double now) {
  const std::vector<const TaskReport*> found = by_task(reports);
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (found[i] != nullptr && tasks_[i].is_missing()) take_one(tasks_[i], static_cast<int>(i) + 1, *found[i], now);
  }
}

int TaskArray::missing() const {
  return static_cast<int>(std::ranges::count_if(tasks_, &Task::is_missing));
}

std::string TaskArray::reason_of(int number, const Task& task) const {
  std::string text = printable(task.report.words);
  if (!task.report.node.empty()) text += fmt::format(" on {}", printable(task.report.node));
  // Slurm's and Mottle's own words on how it ended.
  std::string last;
  for (const std::string& line : split_text(last_part(task_folder(folder_, number) / "output.txt"), '\n')) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  constexpr std::size_t k_longest = 300;
  if (!last.empty()) text += fmt::format("; it said: {}", shortened(printable(last), k_longest));
  return text;
}

/// A node that the scheduler has lost may still be at work: then the task's heartbeat moves.
bool TaskArray::is_dead(Task& task, int number, double now, const TaskPatience& patience) const {
  const std::filesystem::path folder = task_folder(folder_, number);
  if (const std::string beat = read_heartbeat(folder); beat != task.beat) {
    task.beat = beat;
    task.last_beat = now;
  }
  if (task.is_ended()) {
    const double wait = task.report.is_success ? patience.after_end : patience.after_death;
    return now >= std::max(task.ended_at, task.last_beat) + wait;
  }
  if (now < std::max(task.missing_since, task.last_beat) + patience.after_silence) return false;
  if (is_store_held(folder / k_run_store)) {
    task.last_beat = now;
    return false;
  }
  if (task.is_given_up) return true;
  give_up(folder);
  task.is_given_up = true;
  task.missing_since = now;
  return false;
}

std::vector<TaskDeath> TaskArray::find_deaths(double now, const TaskPatience& patience) {
  std::vector<TaskDeath> deaths;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    Task& task = tasks_[i];
    const int number = static_cast<int>(i) + 1;
    if (task.is_over || task.left == 0 || !(task.is_ended() || task.is_missing())) continue;
    if (!is_dead(task, number, now, patience)) continue;
    if (task.is_missing()) {
      task.report.words = "the scheduler does not know it any more, and it gives no sign of life";
      task.report.state = TaskReport::State::ended;
    }
    task.is_over = true;
    std::error_code ignored;
    TaskDeath death{.task = number,
                    .has_begun = task.bytes > 0,
                    .was_given_up = task.is_given_up,
                    .is_disk_full = std::filesystem::exists(task_folder(folder_, number) / k_full_disk, ignored),
                    .reason = reason_of(number, task)};
    for (std::size_t run = task.next; run < task.end; ++run) {
      if (!is_seen_[run]) death.missing.push_back(keys_[run]);
    }
    deaths.push_back(std::move(death));
  }
  return deaths;
}

void TaskArray::for_each_awaited(const std::function<void(const Digest& key)>& visit) const {
  for (const Task& task : tasks_) {
    for (std::size_t run = task.next; run < task.end && !task.is_over; ++run) {
      if (!is_seen_[run]) visit(keys_[run]);
    }
  }
}

std::vector<Digest> TaskArray::withdraw() {
  std::vector<Digest> keys;
  for_each_awaited([&](const Digest& key) { keys.push_back(key); });
  for (Task& task : tasks_) task.is_over = true;
  return keys;
}

int TaskArray::unfinished() const {
  return static_cast<int>(
      std::ranges::count_if(tasks_, [](const Task& task) { return !task.is_over && task.left > 0; }));
}

int TaskArray::running() const {
  return static_cast<int>(std::ranges::count_if(tasks_, [](const Task& task) {
    return !task.is_over && task.left > 0 && task.report.state == TaskReport::State::running;
  }));
}

bool TaskArray::is_left() const {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const Task& task = tasks_[i];
    if (task.is_over || (task.left == 0 && task.report.state == TaskReport::State::ended)) continue;
    if (task.left > 0 || !read_task_end(folder_, static_cast<int>(i) + 1)) return false;
  }
  return true;
}

double TaskArray::seconds_a_run() const {
  double seconds = 0.0;
  std::size_t runs = 0;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const std::optional<TaskEnd> end = read_task_end(folder_, static_cast<int>(i) + 1);
    if (!end) continue;
    seconds += end->seconds;
    runs += end->runs;
  }
  return runs == 0 ? 0.0 : seconds / static_cast<double>(runs);
}

}  // namespace mottle::drivers
