// Runs of a batch that are not there yet: which of them are to be submitted next, and in which tasks.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
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
    bool is_begun = true;  ///< else no run is to blame: the tasks ended before they began, or the disk was full
  };

  explicit RunQueue(const SchedulerOptions& options) : options_(options) {}

  /// Adds the run of a sample; several samples may need the same.
  ///
  /// @param deaths  of tasks that were at it before
  void add(const Digest& key, Eigen::Index sample, int deaths = 0);
  /// Says that a task does it already.
  void is_awaited(const Digest& key);
  bool empty() const { return left_ == 0; }
  bool wants(const Digest& key) const { return find(key) != nullptr; }
  std::size_t to_submit() const { return waiting_.size() + suspects_.size(); }

  /// The run is there: the samples that waited for it.
  std::vector<Eigen::Index> take(const Digest& key);
  /// What a task left is to be submitted again. The run that it was at is charged with the death, and from now on alone
  /// in a task; one that has been charged as often as is allowed is a failure, and nobody waits for it any more in
  /// tasks.
  std::optional<Failure> put_back(const TaskDeath& death);
  /// Runs of tasks that were never submitted, in their order, are to be submitted again before all others.
  void take_back(const std::vector<Digest>& keys);
  /// Of tasks that were at the run; 0: nobody waits for it.
  int deaths_of(const Digest& key) const;

  /// Runs of the next array, taken off the queue: keys and the ends of tasks; `samples` has a row for each.
  struct Next {
    std::vector<Digest> keys = {};
    std::vector<Eigen::Index> samples = {};
    std::vector<std::size_t> ends = {};
  };
  Next next(int max_tasks, double seconds_a_run);

 private:
  /// 24 bytes and, in the table, 5 to 11 more: hundreds of thousands of runs may wait.
  struct Wanted {
    Digest key = {};
    std::uint32_t sample = 0;
    std::uint8_t deaths = 0;        ///< of tasks that were at it
    std::uint8_t early_deaths = 0;  ///< of tasks that would have begun with it
    bool is_placed = false;         ///< in a task, or failed; else it is in a queue
    bool is_taken = false;          ///< nobody waits for it any more
  };
  struct HashDigest {
    std::size_t operator()(const Digest& digest) const { return digest[0]; }
  };
  std::size_t slot_of(const Digest& key) const;
  void grow_table();
  /// Null where nobody waits for it.
  const Wanted* find(const Digest& key) const;
  Wanted* find(const Digest& key) { return const_cast<Wanted*>(std::as_const(*this).find(key)); }
  std::uint32_t number_of(const Wanted& run) const { return static_cast<std::uint32_t>(&run - wanted_.data()); }
  void queue_first(Wanted& run);
  void move_into(Next& next, std::deque<std::uint32_t>& queue, std::size_t runs);

  SchedulerOptions options_;
  std::vector<Wanted> wanted_;                                        // in the order in which they were added
  std::vector<std::uint32_t> table_;                                  // by key: 1 + number in wanted_; 0: free
  std::size_t left_ = 0;                                              // that are not taken
  std::unordered_multimap<Digest, Eigen::Index, HashDigest> others_;  // samples with the same run
  std::deque<std::uint32_t> waiting_;
  std::deque<std::uint32_t> suspects_;
};

}  // namespace mottle::drivers
