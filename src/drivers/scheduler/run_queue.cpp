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

void RunQueue::add(const Digest& key, Eigen::Index sample) {
  const auto [entry, is_new] = wanted_.try_emplace(key, Wanted{.sample = sample});
  if (is_new) {
    waiting_.push_back(key);
  } else {
    others_.emplace(key, sample);
  }
}

void RunQueue::is_awaited(const Digest& key) {
  const auto found = wanted_.find(key);
  if (found != wanted_.end()) found->second.is_placed = true;  // next() passes it over
}

std::vector<Eigen::Index> RunQueue::take(const Digest& key) {
  const auto found = wanted_.find(key);
  if (found == wanted_.end()) return {};
  std::vector<Eigen::Index> samples{found->second.sample};
  const auto [begin, end] = others_.equal_range(key);
  for (auto other = begin; other != end; ++other) samples.push_back(other->second);
  others_.erase(begin, end);
  wanted_.erase(found);
  return samples;
}

std::optional<RunQueue::Failure> RunQueue::put_back(const TaskDeath& death) {
  std::optional<Failure> failure;
  // The first in the order of the runs is to be the first again.
  for (auto key = death.missing.rbegin(); key != death.missing.rend(); ++key) {
    const auto found = wanted_.find(*key);
    if (found == wanted_.end()) continue;
    Wanted& run = found->second;
    int& deaths = death.has_begun ? run.deaths : run.early_deaths;
    if (*key == death.missing.front() && ++deaths >= options_.tries) {
      const std::string times = deaths == 1 ? "once" : fmt::format("{} times", deaths);
      failure = {*key,
                 fmt::format("the task that did it ended {} before it did, last: {} (run {})", times, death.reason,
                             SolverRuns::id_of(*key)),
                 death.has_begun};
      continue;
    }
    run.is_placed = false;
    (run.deaths > 0 ? suspects_ : waiting_).push_front(*key);
  }
  return failure;
}

void RunQueue::move_into(Next& next, std::deque<Digest>& queue, std::size_t runs) {
  const std::size_t before = next.keys.size();
  while (!queue.empty() && next.keys.size() < before + runs) {
    const Digest key = queue.front();
    queue.pop_front();
    const auto found = wanted_.find(key);
    if (found == wanted_.end() || found->second.is_placed) continue;
    found->second.is_placed = true;
    next.keys.push_back(key);
    next.samples.push_back(found->second.sample);
  }
  if (next.keys.size() > before) next.ends.push_back(next.keys.size());
}

RunQueue::Next RunQueue::next(int max_tasks, double seconds_a_run) {
  Next next;
  const auto is_full = [&] { return static_cast<int>(next.ends.size()) >= max_tasks; };
  while (!suspects_.empty() && !is_full()) move_into(next, suspects_, 1);
  const std::size_t runs = waiting_.size();
  const int each = runs == 0 ? 1 : runs_of_task(runs, seconds_a_run, options_);
  while (!waiting_.empty() && !is_full()) move_into(next, waiting_, static_cast<std::size_t>(each));
  return next;
}

}  // namespace mottle::drivers
