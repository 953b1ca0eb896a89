#include "mottle/drivers/scheduler/run_queue.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/drivers/command/solver_runs.hpp"

namespace mottle::drivers {

int runs_of_task(std::size_t runs, double seconds_a_run, const SchedulerOptions& options) {
  constexpr double k_task_s = 600.0;
  constexpr double k_usual_run_s = 60.0;  // where the time of a run is not known
  constexpr double k_used_part = 0.7;     // of the time that a task may take
  if (options.runs_per_task > 0) return options.runs_per_task;
  const double seconds = seconds_a_run > 0.0 ? seconds_a_run : k_usual_run_s;
  double most = k_task_s / seconds;
  if (options.time.count() > 0) {
    most = std::min(most, k_used_part * static_cast<double>(options.time.count()) / 1000.0 / seconds);
  }
  const auto at_once =
      static_cast<std::size_t>(options.runs_at_once > 0 ? options.runs_at_once : k_usual_tasks_at_once);
  const std::size_t share = (runs + at_once - 1) / at_once;
  return std::max(1, static_cast<int>(std::floor(std::min(most, static_cast<double>(share)))));
}

/// Where a key stands in the table, or the free slot where it would.
std::size_t RunQueue::slot_of(const Digest& key) const {
  const std::size_t mask = table_.size() - 1;  // of a power of two
  std::size_t slot = key[0] & mask;
  while (table_[slot] != 0 && wanted_[table_[slot] - 1].key != key) slot = (slot + 1) & mask;
  return slot;
}

/// At most half of the slots are in use.
void RunQueue::grow_table() {
  constexpr std::size_t k_first = 64;
  if (2 * (wanted_.size() + 1) <= table_.size()) return;
  table_.assign(std::max(k_first, 2 * table_.size()), 0);
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    table_[slot_of(wanted_[i].key)] = static_cast<std::uint32_t>(i + 1);
  }
}

const RunQueue::Wanted* RunQueue::find(const Digest& key) const {
  if (table_.empty()) return nullptr;
  const std::uint32_t number = table_[slot_of(key)];
  return number == 0 || wanted_[number - 1].is_taken ? nullptr : &wanted_[number - 1];
}

void RunQueue::add(const Digest& key, Eigen::Index sample, int deaths) {
  grow_table();
  std::uint32_t& number = table_[slot_of(key)];
  if (number != 0) {
    require(!wanted_[number - 1].is_taken, "a run is added to a batch that has given it already");
    others_.emplace(key, sample);
    return;
  }
  constexpr int k_most_deaths = 200;
  (deaths > 0 ? suspects_ : waiting_).push_back(static_cast<std::uint32_t>(wanted_.size()));
  wanted_.push_back({.key = key,
                     .sample = static_cast<std::uint32_t>(sample),
                     .deaths = static_cast<std::uint8_t>(std::min(deaths, k_most_deaths))});
  number = static_cast<std::uint32_t>(wanted_.size());
  ++left_;
}

void RunQueue::is_awaited(const Digest& key) {
  if (Wanted* run = find(key)) run->is_placed = true;  // next() passes it over
}

std::vector<Eigen::Index> RunQueue::take(const Digest& key) {
  Wanted* run = find(key);
  if (run == nullptr) return {};
  std::vector<Eigen::Index> samples{run->sample};
  const auto [begin, end] = others_.equal_range(key);
  for (auto other = begin; other != end; ++other) samples.push_back(other->second);
  others_.erase(begin, end);
  run->is_taken = true;
  --left_;
  return samples;
}

std::optional<RunQueue::Failure> RunQueue::put_back(const TaskDeath& death) {
  std::optional<Failure> failure;
  // The first in the order of the runs is to be the first again.
  for (auto key = death.missing.rbegin(); key != death.missing.rend(); ++key) {
    Wanted* run = find(*key);
    if (run == nullptr) continue;
    const bool is_charged = death.has_begun && !death.is_disk_full && !death.was_given_up;
    std::uint8_t& deaths = is_charged ? run->deaths : run->early_deaths;
    if (*key == death.missing.front() && ++deaths >= options_.tries) {
      const std::string times = deaths == 1 ? "once" : fmt::format("{} times", deaths);
      failure = {*key,
                 fmt::format("the task that did it ended {} before it did, last: {} (run {})", times, death.reason,
                             SolverRuns::id_of(*key)),
                 is_charged};
      continue;
    }
    run->is_placed = false;
    (run->deaths > 0 ? suspects_ : waiting_).push_front(number_of(*run));
  }
  return failure;
}

int RunQueue::deaths_of(const Digest& key) const {
  const Wanted* run = find(key);
  return run == nullptr ? 0 : run->deaths;
}

void RunQueue::move_into(Next& next, std::deque<std::uint32_t>& queue, std::size_t runs) {
  const std::size_t before = next.keys.size();
  while (!queue.empty() && next.keys.size() < before + runs) {
    Wanted& run = wanted_[queue.front()];
    queue.pop_front();
    if (run.is_taken || run.is_placed) continue;
    run.is_placed = true;
    next.keys.push_back(run.key);
    next.samples.push_back(run.sample);
  }
  if (next.keys.size() > before) next.ends.push_back(next.keys.size());
}

RunQueue::Next RunQueue::next(int max_tasks, double seconds_a_run) {
  Next next;
  const auto is_full = [&] { return static_cast<int>(next.ends.size()) >= max_tasks; };
  while (!suspects_.empty() && !is_full()) move_into(next, suspects_, 1);
  const std::size_t runs = waiting_.size();
  const int each = runs == 0 ? 1 : runs_of_task(runs, seconds_a_run, options_);
  const std::size_t most =
      next.keys.size() + std::min(runs, static_cast<std::size_t>(max_tasks) * static_cast<std::size_t>(each));
  next.keys.reserve(most);
  next.samples.reserve(most);
  while (!waiting_.empty() && !is_full()) move_into(next, waiting_, static_cast<std::size_t>(each));
  return next;
}

}  // namespace mottle::drivers
