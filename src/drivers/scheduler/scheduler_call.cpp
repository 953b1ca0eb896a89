#include "drivers/scheduler/scheduler_call.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>

#include "drivers/command/run_output.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/solver_process.hpp"

namespace mottle::drivers {
namespace {

constexpr std::chrono::seconds k_patience{60};

/// Whether a variable tells of the job that this Mottle runs in, which a new job would inherit as its own, or narrows
/// what squeue shows and scancel ends.
bool is_job_variable(std::string_view name) {
  constexpr std::array<std::string_view, 5> k_kept{"SLURM_CONF", "SLURM_CLUSTERS", "SLURM_TIME_FORMAT", "PBS_CONF_FILE",
                                                   "PBS_SERVER"};
  constexpr std::array<std::string_view, 12> k_job{"SLURM_",    "SLURMD_",          "SBATCH_MEM", "PBS_",
                                                   "PMI_",      "SQUEUE_",          "SCANCEL_",   "LSB_JOBINDEX",
                                                   "LSB_JOBID", "OMPI_COMM_WORLD_", "PMIX_",      "PRTE_"};
  if (std::ranges::find(k_kept, name) != k_kept.end()) return false;
  return std::ranges::any_of(k_job, [&](std::string_view prefix) { return name.starts_with(prefix); });
}

/// `env` takes away what stays in our own environment.
std::vector<std::string> without_job_variables(const std::vector<std::string>& arguments) {
  std::vector<std::string> call{"/usr/bin/env"};
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const std::string_view name = text.substr(0, text.find('='));
    if (is_job_variable(name)) call.insert(call.end(), {"-u", std::string(name)});
  }
  call.insert(call.end(), arguments.begin(), arguments.end());
  return call;
}

/// Whether a refusal has one of some words, in whatever letters.
bool has_any(const std::string& words, std::span<const std::string_view> parts) {
  std::string small = words;
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::any_of(parts, [&](std::string_view part) { return small.find(part) != std::string::npos; });
}

/// Words of limits on a user's tasks in the queue: they pass as tasks end.
bool is_full_queue(const std::string& words) {
  constexpr std::array<std::string_view, 5> k_full{"job violates accounting/qos policy", "submitjoblimit",
                                                   "would exceed", "pending job threshold", "maximum number of jobs"};
  return has_any(words, k_full);
}

/// Words of limits on the tasks of one array.
bool is_long_array(const std::string& words) {
  constexpr std::array<std::string_view, 3> k_long{"invalid job array specification", "array job exceeds",
                                                   "array index too large"};
  return has_any(words, k_long);
}

/// Words of schedulers that are busy, restarted, or out of reach.
bool is_passing(const std::string& words) {
  constexpr std::array<std::string_view, 19> k_passing{"unable to contact",
                                                       "socket timed out",
                                                       "connection refused",
                                                       "connection timed out",
                                                       "connection reset",
                                                       "cannot connect",
                                                       "could not connect",
                                                       "zero bytes were transmitted",
                                                       "communication failure",
                                                       "communication connection failure",
                                                       "temporarily",
                                                       "try again",
                                                       "please wait",
                                                       "retrying",
                                                       "slurm backup controller",
                                                       "transport endpoint",
                                                       "cannot be submitted now",
                                                       "no route to host",
                                                       "batch system concurrently executing"};
  return has_any(words, k_passing);
}

}  // namespace

CommandAnswer ask_scheduler(const std::vector<std::string>& arguments, const std::atomic<bool>* stop) {
  if (find_program(arguments.front()).empty()) {
    throw SystemFailure(fmt::format(
        "there is no program '{}' on PATH, which model.launch needs; start Mottle where jobs can be submitted",
        arguments.front()));
  }
  const TemporaryFolder folder;
  const ProcessEnd end = run_process({.arguments = without_job_variables(arguments),
                                      .directory = folder.path(),
                                      .environment = {{"LC_ALL", "C"}},
                                      .timeout = k_patience,
                                      .stop = stop});
  if (end.kind == ProcessEnd::Kind::stopped) throw Stopped("stopped on request");
  if (end.kind == ProcessEnd::Kind::lost) throw SchedulerSilent(fmt::format("{}: {}", arguments.front(), end.reason));
  if (end.kind == ProcessEnd::Kind::timed_out) {
    throw SchedulerSilent(fmt::format("{} gave no answer within {} s", arguments.front(), k_patience.count()));
  }
  CommandAnswer answer{.is_done = end.kind == ProcessEnd::Kind::done,
                       .output = read_file(folder.path() / k_standard_output),
                       .error = read_file(folder.path() / k_standard_error)};
  if (!answer.is_done && answer.error.empty()) answer.error = end.reason;
  return answer;
}

void refuse_answer(const std::string& command, const CommandAnswer& answer) {
  constexpr std::size_t k_longest = 600;
  std::string words = answer.error;
  while (!words.empty() && words.back() == '\n') words.pop_back();
  std::ranges::replace(words, '\n', ' ');
  const std::string text = fmt::format("{} says: {}", command, shortened(printable(words), k_longest));
  if (is_full_queue(words)) throw TooManyTasks(text, true);
  if (is_long_array(words)) throw TooManyTasks(text, false);
  if (is_passing(words)) throw SchedulerSilent(text);
  throw SystemFailure(text);
}

std::string job_number(std::string_view output) {
  std::string number;
  for (const std::string& line : split_text(output, '\n')) {
    const std::size_t end = line.find_first_not_of("0123456789");
    if (end == 0 || line.empty() ||
        (end != std::string::npos && std::string_view(";[.").find(line[end]) == std::string_view::npos))
      continue;
    number = line.substr(0, line.find_first_of("; \t\r"));
  }
  return number;
}

std::vector<std::string> split_text(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::vector<TaskRow> task_rows(std::string_view output) {
  constexpr std::size_t k_fields = 5;
  std::vector<TaskRow> rows;
  for (const std::string& line : split_text(output, '\n')) {
    std::vector<std::string> fields = split_text(line, '|');
    double number = 0.0;
    if (fields.size() < k_fields || !parse_number(fields[1], number)) continue;
    rows.push_back({static_cast<int>(number), std::move(fields)});
  }
  return rows;
}

std::string licence_assignment(const std::string& licences) {
  const std::size_t colon = licences.find(':');
  if (colon == std::string::npos) return licences + "=1";
  return licences.substr(0, colon) + "=" + licences.substr(colon + 1);
}

std::string clock_text(std::chrono::milliseconds time) {
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(time).count();
  return fmt::format("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
}

std::string scheduler_name(SchedulerKind kind) {
  return kind == SchedulerKind::slurm ? "Slurm" : kind == SchedulerKind::pbs ? "PBS" : "LSF";
}

std::unique_ptr<Scheduler> make_scheduler(const SchedulerOptions& options, const std::atomic<bool>* stop) {
  if (options.kind == SchedulerKind::slurm) return make_slurm(options, stop);
  if (options.kind == SchedulerKind::pbs) return make_pbs(options, stop);
  return make_lsf(options, stop);
}

}  // namespace mottle::drivers
