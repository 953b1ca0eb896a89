// Does runs of a solver by tasks of a scheduler: submits arrays of those that are missing, reads what the tasks have
// kept, and submits again what died with a task. Nothing but files and the scheduler's own commands connects it to the
// tasks, so that tasks go on where this process ends, and another one finds them.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/scheduler/run_queue.hpp"
#include "mottle/drivers/scheduler/scheduler.hpp"
#include "mottle/drivers/scheduler/task_array.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Where tasks are.
struct TaskPlace {
  std::filesystem::path results = {};
  bool is_temporary = false;  ///< after a stop nobody comes back for them
  bool is_resumed = false;    ///< runs that failed in tasks of an earlier Mottle count
};

class DeathCharges;

class ScheduledRuns {
 public:
  /// Finds the arrays that an earlier Mottle has left in the folder of results: what they did is kept, those that still
  /// run are waited for, and those of another study are ended.
  ///
  /// @param runs     knows the runs' inputs and keeps their results; outlives this object
  /// @param place    the folder of results, or one that only this job has and whose tasks end with it
  /// @throws SystemFailure
  ScheduledRuns(SolverRuns& runs, const TaskPlace& place, std::unique_ptr<Scheduler> scheduler,
                const TaskPatience& patience = {});
  /// Ends tasks that nobody waits for any more; after a stop request they go on.
  ~ScheduledRuns();
  ScheduledRuns(const ScheduledRuns&) = delete;
  ScheduledRuns& operator=(const ScheduledRuns&) = delete;

  /// Calls `deliver` for each sample, from this thread, as its run is there.
  ///
  /// @param samples  [sample x parameter]
  /// @throws FormatError    by `deliver`, as the sample's failure: a value does not fit into its placeholder
  /// @throws SystemFailure  the scheduler refuses the array; tasks die before they begin; disk full
  /// @throws InvalidInput   the study's files have changed meanwhile
  /// @throws Stopped        tasks go on
  using Deliver = std::function<void(Eigen::Index sample, const SolverRuns::Run& run)>;
  void run_all(const Eigen::Ref<const Eigen::MatrixXd>& samples, int min_modes, const RunContext& context,
               const Deliver& deliver);

  /// From now on a batch's observer writes a log: until then notes are kept for it.
  void begin_log() { has_log_ = true; }

  /// Time of a run, as tasks have measured it; 0: not known yet.
  double seconds_a_run() const { return seconds_a_run_; }

 private:
  struct Batch;
  void adopt(bool is_resumed);
  void begin_batch(Batch& batch);
  void go_on(Batch& batch);
  void read_stores(Batch& batch);
  void finish_run(Batch& batch, const Digest& key, RunRecord record, const std::filesystem::path& task);
  void bury(Batch& batch, const TaskArray& array, const TaskDeath& death);
  void submit_more(Batch& batch);
  void make_array(Batch& batch, RunQueue::Next next, int limit);
  void submit(TaskArray& array, Batch& batch);
  void try_later(TaskArray& array, const RunContext& context, const std::string& words);
  void withdraw(TaskArray& array, Batch& batch, const std::string& words);
  void ask(const RunContext& context);
  void clean();
  void discard(TaskArray& array);
  void warn_of_old_options(const TaskArray& array, const SchedulerOptions& old);
  void look_for_missing(const RunContext& context);
  void keep_unasked(const Digest& key, std::string_view record);
  void wait_a_moment(const RunContext& context, double seconds);
  void note(const RunContext& context, const std::string& text);
  void say_silence(const RunContext& context, const std::string& words);
  void show_tasks(const RunContext& context) const;
  [[noreturn]] void stop(const std::string& why);
  int unfinished() const;
  int free_limit() const;

  SolverRuns& runs_;
  std::filesystem::path results_;
  std::unique_ptr<Scheduler> scheduler_;
  SchedulerOptions options_;
  TaskPatience patience_;
  std::vector<std::unique_ptr<TaskArray>> arrays_;
  std::unique_ptr<DeathCharges> charges_;
  int most_tasks_ = k_most_tasks;  ///< in the queue, as far as it takes them
  double seconds_a_run_ = 0.0;
  double next_question_ = 0.0;
  double question_interval_ = 0.0;
  bool has_log_ = false;
  bool is_silent_ = false;
  bool is_temporary_;
  bool leaves_tasks_ = false;
  std::vector<std::string> notes_ = {};     ///< for the log, once there is one
  std::vector<std::string> warnings_ = {};  ///< likewise, for the user too
};

}  // namespace mottle::drivers
