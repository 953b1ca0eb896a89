// Slurm: sbatch, squeue, scancel.
#include <algorithm>
#include <array>

#include "drivers/scheduler/scheduler_call.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/solver_process.hpp"

namespace mottle::drivers {
namespace {

/// States after which a task does nothing more; of others it may.
bool is_end(std::string_view state) {
  constexpr std::array<std::string_view, 11> k_ends{"BOOT_FAIL",     "CANCELLED", "COMPLETED",     "DEADLINE",
                                                    "FAILED",        "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED",
                                                    "LAUNCH_FAILED", "REVOKED",   "TIMEOUT"};
  return std::ranges::find(k_ends, state) != k_ends.end();
}

class SlurmScheduler final : public Scheduler {
 public:
  SlurmScheduler(SchedulerOptions options, const std::atomic<bool>* stop) : options_(std::move(options)), stop_(stop) {}

  std::string submit(const ArrayRequest& request) override {
    std::string array = fmt::format("--array=1-{}", request.tasks);
    if (request.limit > 0) array += fmt::format("%{}", request.limit);
    // Slurm expands % and \ in the name, of the folder too; job.sh writes the same file, without Slurm's own words.
    const bool is_plain = request.folder.string().find_first_of("%\\") == std::string::npos;
    std::vector<std::string> call{"sbatch",
                                  "--parsable",
                                  "--job-name=" + request.name,
                                  array,
                                  "--chdir=" + request.folder.string(),
                                  is_plain ? "--output=task-%a/output.txt" : "--output=/dev/null",
                                  "--open-mode=append",
                                  "--input=none",
                                  "--nodes=1",
                                  "--ntasks=1",
                                  fmt::format("--cpus-per-task={}", options_.cores)};
    if (!options_.partition.empty()) call.push_back("--partition=" + options_.partition);
    if (!options_.account.empty()) call.push_back("--account=" + options_.account);
    if (!options_.licences.empty()) call.push_back("--licenses=" + options_.licences);
    if (options_.time.count() > 0) call.push_back("--time=" + clock_text(options_.time));
    call.insert(call.end(), options_.extra.begin(), options_.extra.end());
    call.push_back(request.script.string());
    const CommandAnswer answer = ask_scheduler(call, stop_);
    if (!answer.is_done) refuse_answer("sbatch", answer);
    return job_number(answer.output);
  }

  std::vector<TaskReport> list(const std::vector<std::string>& names) override {
    const CommandAnswer answer = ask_scheduler(
        {"squeue", "--noheader", "--array", "--states=all", "--name=" + join(names, ","), "--format=%j|%K|%T|%N|%r"},
        stop_);
    if (!answer.is_done) throw SchedulerSilent(fmt::format("squeue says: {}", answer.error));
    return read_squeue(answer.output);
  }

  /// The controller by the job's number, which no filter of squeue narrows; else the accounting, where there is one.
  std::vector<TaskReport> look_up(const std::string& /*name*/, const std::string& job) override {
    if (job.empty()) return {};
    const CommandAnswer shown = ask_scheduler({"scontrol", "show", "job", "--oneliner", job}, stop_);
    const bool is_unknown = shown.error.find("Invalid job id") != std::string::npos;
    if (!shown.is_done && !is_unknown) throw SchedulerSilent(fmt::format("scontrol says: {}", shown.error));
    std::vector<TaskReport> reports = read_scontrol(shown.output);
    if (!reports.empty() || find_program("sacct").empty()) return reports;
    const CommandAnswer counted = ask_scheduler({"sacct", "--noheader", "--parsable2", "--allocations", "--array",
                                                 "--jobs=" + job, "--format=JobName,JobID,State,NodeList"},
                                                stop_);
    return read_sacct(counted.output);  // nothing where there is no accounting
  }

  void cancel(const std::string& name) override {
    const CommandAnswer answer = ask_scheduler({"scancel", "--name=" + name}, nullptr);
    if (!answer.is_done) refuse_answer("scancel", answer);
  }

  std::string number_variable() const override { return "SLURM_ARRAY_TASK_ID"; }

 private:
  SchedulerOptions options_;
  const std::atomic<bool>* stop_;
};

/// By one of Slurm's words for a state.
TaskReport report_of(const std::string& array, int task, const std::string& state, const std::string& node) {
  TaskReport report{.array = array, .task = task, .node = node, .words = state};
  if (is_end(state)) {
    report.state = TaskReport::State::ended;
    report.is_success = state == "COMPLETED";
  } else if (state == "RUNNING" || state == "COMPLETING" || state == "SUSPENDED") {
    report.state = TaskReport::State::running;
  }
  return report;
}

/// Numbers in "3", "1-4%2", "2,5-7".
std::vector<int> numbers_of(std::string_view text) {
  constexpr int k_most = 1'000'000;
  std::vector<int> numbers;
  for (const std::string& part : split_text(text.substr(0, text.find('%')), ',')) {
    const std::size_t dash = part.find('-');
    double first = 0.0;
    double last = 0.0;
    if (!parse_number(part.substr(0, dash), first)) continue;
    if (dash == std::string::npos || !parse_number(part.substr(dash + 1), last)) last = first;
    if (first < 0.0 || last > k_most) continue;
    for (int number = static_cast<int>(first); number <= static_cast<int>(last); ++number) numbers.push_back(number);
  }
  return numbers;
}

/// The value of "Key=Value" in a line of scontrol; empty: it is not there.
std::string value_in(const std::string& line, const std::string& key) {
  for (const std::string& word : split_text(line, ' ')) {
    if (word.starts_with(key + "=")) return word.substr(key.size() + 1);
  }
  return {};
}

}  // namespace

std::vector<TaskReport> read_scontrol(std::string_view output) {
  std::vector<TaskReport> reports;
  for (const std::string& line : split_text(output, '\n')) {
    const std::string array = value_in(line, "JobName");
    const std::string state = value_in(line, "JobState");
    const std::string node = value_in(line, "NodeList");
    if (array.empty() || state.empty()) continue;
    for (const int task : numbers_of(value_in(line, "ArrayTaskId"))) {
      reports.push_back(report_of(array, task, state, node == "(null)" ? "" : node));
    }
  }
  return reports;
}

std::vector<TaskReport> read_sacct(std::string_view output) {
  constexpr std::size_t k_fields = 4;
  std::vector<TaskReport> reports;
  for (const std::string& line : split_text(output, '\n')) {
    const std::vector<std::string> fields = split_text(line, '|');
    const std::size_t bar = fields.size() < k_fields ? std::string::npos : fields[1].find('_');
    if (bar == std::string::npos) continue;
    std::string tasks = fields[1].substr(bar + 1);  // "3", "[4-9%2]"
    std::erase_if(tasks, [](char c) { return c == '[' || c == ']'; });
    const std::string state = fields[2].substr(0, fields[2].find(' '));  // "CANCELLED by 1000"
    const std::string node = fields[3] == "None assigned" ? "" : fields[3];
    for (const int task : numbers_of(tasks)) reports.push_back(report_of(fields[0], task, state, node));
  }
  return reports;
}

std::vector<TaskReport> read_squeue(std::string_view output) {
  std::vector<TaskReport> reports;
  for (const auto& [task, fields] : task_rows(output)) {
    TaskReport report = report_of(fields[0], task, fields[2], fields[3]);
    if (report.state == TaskReport::State::waiting && fields[4] != "None" && !fields[4].empty()) {
      report.words += fmt::format(" ({})", fields[4]);  // "PENDING (Resources)"
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

std::unique_ptr<Scheduler> make_slurm(const SchedulerOptions& options, const std::atomic<bool>* stop) {
  return std::make_unique<SlurmScheduler>(options, stop);
}

}  // namespace mottle::drivers
