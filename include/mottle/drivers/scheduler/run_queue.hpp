// Runs of a batch that are not there yet: which of them are to be submitted next, and in which tasks.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/scheduler/array_folder.hpp"
#include "mottle/drivers/scheduler/task_array.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

inline constexpr int k_most_tasks = 1000;  ///< of one study at a time; Slurm's arrays have no more by default

/// Tasks at work together where the study does not say it.
inline constexpr int k_usual_tasks_at_once = 100;

/// Runs that each task does, so that it takes about ten minutes and well less than it may, but so few that as many
/// tasks are made as can be at work together.
///
/// @param runs           to be done, >= 1
/// @param seconds_a_run  0: not known
int runs_of_task(std::size_t runs, double seconds_a_run, const SchedulerOptions& options);

class RunQueue {
 public:
  /// A run whose tasks ended too often.
  struct Failure {
    Digest key = {};
    std::string text = {};
    bool is_begun = true;  ///< else the tasks ended before they began: no run is to blame
  };

  explicit RunQueue(const SchedulerOptions& options) : options_(options) {}

  /// Adds the run of a sample; several samples may need the same.
  void add(const Digest& key, Eigen::Index sample);
  /// Says that a task does it already.
  void is_awaited(const Digest& key);
  bool empty() const { return wanted_.empty(); }
  bool wants(const Digest& key) const { return wanted_.contains(key); }
  std::size_t to_submit() const { return waiting_.size() + suspects_.size(); }

  /// The run is there: the samples that waited for it.
  std::vector<Eigen::Index> take(const Digest& key);
  /// What a task left is to be submitted again. The run that it was at is charged with the death, and from now on alone
  /// in a task; one that has been charged as often as is allowed is a failure, and nobody waits for it any more in
  /// tasks.
  std::optional<Failure> put_back(const TaskDeath& death);

  /// Runs of the next array, taken off the queue: keys and the ends of tasks; `samples` has a row for each.
  struct Next {
    std::vector<Digest> keys = {};
    std::vector<Eigen::Index> samples = {};
    std::vector<std::size_t> ends = {};
  };
  Next next(int max_tasks, double seconds_a_run);

 private:
  struct Wanted {
    Eigen::Index sample = 0;
    int deaths = 0;          ///< of tasks that were at it
    int early_deaths = 0;    ///< of tasks that would have begun with it
    bool is_placed = false;  ///< in a task, or failed; else it is in a queue
  };
  struct HashDigest {
    std::size_t operator()(const Digest& digest) const { return digest[0]; }
  };
  void move_into(Next& next, std::deque<Digest>& queue, std::size_t runs);

  SchedulerOptions options_;
  std::unordered_map<Digest, Wanted, HashDigest> wanted_;
  std::unordered_multimap<Digest, Eigen::Index, HashDigest> others_;  // samples with the same run
  std::deque<Digest> waiting_;
  std::deque<Digest> suspects_;
};

}  // namespace mottle::drivers
