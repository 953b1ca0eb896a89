// A scheduler of a cluster: submits arrays of tasks, says what has become of them, and cancels them, by its own
// commands. Arrays are known by names that nobody else uses, so that one can be found again whose number was never
// read.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/drivers/scheduler/scheduler_options.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// The scheduler gave no answer, or one that means "later": what was asked may or may not have been done.
class SchedulerSilent : public SystemFailure {
 public:
  using SystemFailure::SystemFailure;
};

/// The array has more tasks than one may have, or than this user may have in the queue; nothing was submitted.
class TooManyTasks : public SystemFailure {
 public:
  TooManyTasks(const std::string& words, bool is_passing) : SystemFailure(words), is_passing_(is_passing) {}
  /// Whether there will be room as other tasks end.
  bool is_passing() const { return is_passing_; }

 private:
  bool is_passing_;
};

/// An array of tasks 1 to `tasks`.
struct ArrayRequest {
  std::string name = {};              ///< at most 15 characters, which every PBS takes
  std::filesystem::path script = {};  ///< is handed the task's number in the scheduler's variable
  std::filesystem::path folder = {};  ///< where tasks start; task-N in it takes the output of task N
  int tasks = 1;
  int limit = 0;  ///< of them at work at the same time; 0: any number
};

/// What a scheduler says of one task.
struct TaskReport {
  enum class State { waiting, running, ended };

  std::string array = {};  ///< the array's name
  int task = 0;
  State state = State::waiting;
  std::string node = {};    ///< where it runs or ran; empty: not said
  std::string words = {};   ///< the scheduler's own word: "TIMEOUT"
  bool is_success = false;  ///< of one that ended: as far as the scheduler knows, by itself and well

  bool operator==(const TaskReport&) const = default;
};

class Scheduler {
 public:
  virtual ~Scheduler() = default;

  /// Submits; the scheduler's number of the array.
  ///
  /// @throws SchedulerSilent  it may have been submitted; TooManyTasks; SystemFailure: it was refused, in the
  ///                          scheduler's words
  virtual std::string submit(const ArrayRequest& request) = 0;
  /// All that the scheduler still knows of the arrays' tasks; those that ended long ago are not among them. A task that
  /// is missing need not have ended: commands were seen that exit with 0 and print nothing, or a part.
  ///
  /// @throws SchedulerSilent
  virtual std::vector<TaskReport> list(const std::vector<std::string>& names) = 0;
  /// A second look at an array some of whose tasks are missing: by its number, in another list or the history.
  ///
  /// @param job  what submit() returned; empty: there is nothing to look for
  /// @throws SchedulerSilent
  virtual std::vector<TaskReport> look_up(const std::string& name, const std::string& job) = 0;
  /// Ends all tasks of an array, whatever the stop request says; nothing where there is none of that name. Throws
  /// SchedulerSilent, SystemFailure.
  virtual void cancel(const std::string& name) = 0;
  /// The variable that gives a task its number; where it is not set, the number is 1.
  virtual std::string number_variable() const = 0;
};

/// @param stop  ends the wait for an answer (Stopped is thrown); null: nothing does
std::unique_ptr<Scheduler> make_scheduler(const SchedulerOptions& options, const std::atomic<bool>* stop);

}  // namespace mottle::drivers
