// What a Mottle that waits for an array of tasks knows of it: which runs are there, and which tasks have died.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/drivers/scheduler/array_folder.hpp"
#include "mottle/drivers/scheduler/scheduler.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// How patient a Mottle is with tasks and with the scheduler, in seconds.
struct TaskPatience {
  double first_question = 5.0;  ///< from one question to the scheduler to the next
  double last_question = 30.0;  ///< where nothing happens
  double after_death = 10.0;    ///< for runs of a task that the scheduler calls dead: file systems show files late
  double after_end = 60.0;      ///< for those of a task that ended well, or of which the scheduler knows nothing
  double poll = 0.2;            ///< from one look at the tasks' stores to the next
};

/// A task that has ended without all of its runs.
struct TaskDeath {
  int task = 0;
  std::vector<Digest> missing = {};  ///< in the order in which it would have done them
  bool has_begun = false;            ///< the first of them was being done
  std::string reason = {};           ///< "TIMEOUT on n3; it said: ..."
};

class TaskArray {
 public:
  TaskArray(std::filesystem::path folder, const ArrayPlan& plan);

  const std::filesystem::path& folder() const { return folder_; }
  const std::string& name() const { return name_; }
  const Digest& constants() const { return constants_; }
  int tasks() const { return static_cast<int>(tasks_.size()); }

  /// Reads what the tasks have kept since the last call; the number of runs that were new.
  using Visit = std::function<void(const Digest& key, std::string_view record, int task)>;
  std::size_t read_new(const Visit& visit);
  /// What the scheduler says of its tasks, at time `now` in seconds; whether anything has changed. Two answers in which
  /// a task is missing are its end.
  bool take(const std::vector<TaskReport>& reports, double now);
  /// Tasks that are given up: each is told once.
  std::vector<TaskDeath> find_deaths(double now, const TaskPatience& patience);
  /// Runs of tasks that may still do them, by a call for each.
  void for_each_awaited(const std::function<void(const Digest& key)>& visit) const;

  int unfinished() const;  ///< tasks that may still bring a run
  int running() const;     ///< of these, as the scheduler said
  /// Whether all tasks have said that they are at their end, or are given up: the folder is no longer needed.
  bool is_left() const;
  /// Seconds that a run took in the tasks that have told it; 0: none has.
  double seconds_a_run() const;

  int limit = 0;              ///< of tasks at work at the same time; 0: none
  bool is_submitted = false;  ///< the scheduler is known to have it
  bool is_asked = false;      ///< it may have it
  double next_try = 0.0;      ///< when it is submitted, or asked for, again

 private:
  struct Task {
    std::size_t first = 0, end = 0;  ///< its runs
    std::size_t next = 0;            ///< the first that was not seen yet
    std::uint64_t bytes = 0;         ///< of its store that were read
    std::size_t left = 0;            ///< runs that were not seen
    TaskReport report = {};
    double ended_at = 0.0;
    int absences = 0;  ///< answers in a row in which it was missing
    bool is_over = false;
  };
  bool note_key(Task& task, const Digest& key);
  std::string reason_of(int number, const Task& task) const;

  std::filesystem::path folder_;
  std::string name_;
  Digest constants_;
  std::vector<Digest> keys_;
  std::vector<bool> is_seen_;
  std::vector<Task> tasks_;
};

}  // namespace mottle::drivers
