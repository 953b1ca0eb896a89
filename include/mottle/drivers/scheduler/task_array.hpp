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
  double after_end = 60.0;      ///< for those of a task that ended well
  /// For those of a task that the scheduler does not list: twice, before it is told to do nothing more and after. Its
  /// heartbeat, every 5 s, starts the time anew.
  double after_silence = 150.0;
  double poll = 0.2;  ///< from one look at the tasks' stores to the next
};

/// A task that has ended without all of its runs.
struct TaskDeath {
  int task = 0;
  std::vector<Digest> missing = {};  ///< in the order in which it would have done them
  bool has_begun = false;            ///< the first of them was being done
  bool was_given_up = false;         ///< Mottle told it to do nothing more, which is nobody's fault
  bool is_disk_full = false;         ///< so the task has said: no run is to blame
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
  /// What the scheduler says of its tasks, at time `now` in seconds; whether anything has changed. A task is missing
  /// from the second answer in a row that does not name it.
  bool take(const std::vector<TaskReport>& reports, double now);
  /// What a second look has found of missing tasks; others are as they were.
  void take_found(const std::vector<TaskReport>& reports, double now);
  /// Tasks with runs to do that the scheduler does not list.
  int missing() const;
  /// Tasks that are given up: each is told once. The scheduler's word that one has ended, and its silence on one that
  /// gives no sign of life either: neither its heartbeat moves nor is its store held, and it was told to do no more.
  std::vector<TaskDeath> find_deaths(double now, const TaskPatience& patience);
  /// Runs of tasks that may still do them, by a call for each.
  void for_each_awaited(const std::function<void(const Digest& key)>& visit) const;
  /// Nothing is waited for any more, for it was not submitted; the runs that are to be done by others.
  std::vector<Digest> withdraw();

  int unfinished() const;  ///< tasks that may still bring a run
  int running() const;     ///< of these, as the scheduler said
  /// Whether all tasks have said that they are at their end, or are given up: the folder is no longer needed.
  bool is_left() const;
  /// Seconds that a run took in the tasks that have told it; 0: none has.
  double seconds_a_run() const;

  int limit = 0;                 ///< of tasks at work at the same time; 0: none
  bool is_submitted = false;     ///< the scheduler is known to have it
  bool is_asked = false;         ///< it may have it
  bool is_missing_told = false;  ///< the log says that the scheduler does not list some of its tasks
  double next_try = 0.0;         ///< when it is submitted, or asked for, again

 private:
  struct Task {
    std::size_t first = 0, end = 0;  ///< its runs
    std::size_t next = 0;            ///< the first that was not seen yet
    std::uint64_t bytes = 0;         ///< of its store that were read
    std::size_t left = 0;            ///< runs that were not seen
    TaskReport report = {};
    double ended_at = 0.0;
    double missing_since = 0.0;
    double last_beat = 0.0;    ///< when its heartbeat was seen to move
    std::string beat = {};     ///< what it wrote
    int absences = 0;          ///< answers in a row in which it was missing
    bool is_given_up = false;  ///< it was told so
    bool is_over = false;
    bool is_ended() const { return report.state == TaskReport::State::ended; }
    bool is_missing() const;
  };
  void take_one(Task& task, int number, const TaskReport& report, double now);
  bool is_dead(Task& task, int number, double now, const TaskPatience& patience) const;
  std::vector<const TaskReport*> by_task(const std::vector<TaskReport>& reports) const;
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
