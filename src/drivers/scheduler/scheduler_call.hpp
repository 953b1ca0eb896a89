// Calls of a scheduler's commands, with time limits, and what their answers mean.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/drivers/scheduler/scheduler.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// How a command ended.
struct CommandAnswer {
  bool is_done = false;  ///< exit status 0
  std::string output = {};
  std::string error = {};  ///< what it printed there, or how it ended
};

/// Runs a command in a folder of its own, without variables that a job of the scheduler hands to its processes: what
/// this Mottle was given is not for the tasks.
///
/// @throws SchedulerSilent  no end within a minute; Stopped; SystemFailure: there is no such program
CommandAnswer ask_scheduler(const std::vector<std::string>& arguments, const std::atomic<bool>* stop);

/// Throws what a refusal means: TooManyTasks where a limit of tasks is told, SchedulerSilent where the scheduler cannot
/// be reached, else SystemFailure with its words.
[[noreturn]] void refuse_answer(const std::string& command, const CommandAnswer& answer);

/// The number of a job ("123", "123[].server") in what a submission printed: the last line that begins with it, up to a
/// semicolon, since sites print words of their own before. Empty: there is none.
std::string job_number(std::string_view output);

/// The parts of a text between separators, empty ones among them.
std::vector<std::string> split_text(std::string_view text, char separator);

/// A line about a task: its array, its number and three more fields.
struct TaskRow {
  int task = 0;
  std::vector<std::string> fields = {};
};
/// The lines of five fields between '|' whose second is a number; others are about no task.
std::vector<TaskRow> task_rows(std::string_view output);

/// "ansys=2" of "ansys:2", and "ansys=1" of "ansys".
std::string licence_assignment(const std::string& licences);

/// "02:30:00" of a time, rounded up to seconds.
std::string clock_text(std::chrono::milliseconds time);

std::unique_ptr<Scheduler> make_slurm(const SchedulerOptions& options, const std::atomic<bool>* stop);
std::unique_ptr<Scheduler> make_pbs(const SchedulerOptions& options, const std::atomic<bool>* stop);
std::unique_ptr<Scheduler> make_lsf(const SchedulerOptions& options, const std::atomic<bool>* stop);

/// What squeue, qstat and bjobs printed, as reports; `names` of the arrays that were asked for.
std::vector<TaskReport> read_squeue(std::string_view output);
/// Likewise of `scontrol show job --oneliner` and of `sacct --parsable2 --format=JobName,JobID,State,NodeList`.
std::vector<TaskReport> read_scontrol(std::string_view output);
std::vector<TaskReport> read_sacct(std::string_view output);
std::vector<TaskReport> read_qstat(std::string_view output, const std::vector<std::string>& names);
/// "123" of "Job <123> is submitted to queue <normal>.", which words of the site may come before.
std::string read_bsub(std::string_view output);
std::vector<TaskReport> read_bjobs(std::string_view output);

}  // namespace mottle::drivers
