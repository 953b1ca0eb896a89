// Slurm: sbatch, squeue, scancel.
#include <algorithm>
#include <array>

#include "drivers/scheduler/scheduler_call.hpp"
#include "mottle/core/text.hpp"

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
    return answer.output.substr(0, answer.output.find_first_of(";\n"));
  }

  std::vector<TaskReport> list(const std::vector<std::string>& names) override {
    const CommandAnswer answer = ask_scheduler(
        {"squeue", "--noheader", "--array", "--states=all", "--name=" + join(names, ","), "--format=%j|%K|%T|%N|%r"},
        stop_);
    if (!answer.is_done) throw SchedulerSilent(fmt::format("squeue says: {}", answer.error));
    return read_squeue(answer.output);
  }

  void cancel(const std::string& name) override {
    const CommandAnswer answer = ask_scheduler({"scancel", "--name=" + name}, stop_);
    if (!answer.is_done) refuse_answer("scancel", answer);
  }

  std::string number_variable() const override { return "SLURM_ARRAY_TASK_ID"; }

 private:
  SchedulerOptions options_;
  const std::atomic<bool>* stop_;
};

}  // namespace

std::vector<TaskReport> read_squeue(std::string_view output) {
  std::vector<TaskReport> reports;
  for (const auto& [task, fields] : task_rows(output)) {
    TaskReport report{.array = fields[0], .task = task, .node = fields[3], .words = fields[2]};
    if (is_end(fields[2])) {
      report.state = TaskReport::State::ended;
      report.is_success = fields[2] == "COMPLETED";
    } else if (fields[2] == "RUNNING" || fields[2] == "COMPLETING" || fields[2] == "SUSPENDED") {
      report.state = TaskReport::State::running;
    } else if (fields[4] != "None" && !fields[4].empty()) {
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
