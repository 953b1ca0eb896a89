// LSF: bsub, bjobs, bkill.
#include "drivers/scheduler/scheduler_call.hpp"

namespace mottle::drivers {
namespace {

bool is_unknown(const CommandAnswer& answer) {
  for (const char* words :
       {"is not found", "No matching job", "No unfinished job", "No job found", "already finished"}) {
    if (answer.error.find(words) != std::string::npos) return true;
  }
  return false;
}

class LsfScheduler final : public Scheduler {
 public:
  LsfScheduler(SchedulerOptions options, const std::atomic<bool>* stop) : options_(std::move(options)), stop_(stop) {}

  std::string submit(const ArrayRequest& request) override {
    std::string array = fmt::format("{}[1-{}]", request.name, request.tasks);
    if (request.limit > 0) array += fmt::format("%{}", request.limit);
    std::vector<std::string> call{"bsub", "-J",           array,       "-cwd", request.folder.string(),
                                  "-r",   "-o",           "/dev/null", "-n",   fmt::format("{}", options_.cores),
                                  "-R",   "span[hosts=1]"};
    const auto add = [&](const std::string& option, const std::string& value) {
      call.insert(call.end(), {option, value});
    };
    if (!options_.partition.empty()) add("-q", options_.partition);
    if (!options_.account.empty()) add("-P", options_.account);
    if (options_.time.count() > 0) {
      add("-W", fmt::format("{}", std::chrono::ceil<std::chrono::minutes>(options_.time).count()));
    }
    if (!options_.licences.empty()) add("-R", fmt::format("rusage[{}]", licence_assignment(options_.licences)));
    call.insert(call.end(), options_.extra.begin(), options_.extra.end());
    call.push_back("./" + request.script.filename().string());  // LSF makes a line for a shell of it
    const CommandAnswer answer = ask_scheduler(call, stop_);
    if (!answer.is_done) refuse_answer("bsub", answer);
    return read_bsub(answer.output);
  }

  std::vector<TaskReport> list(const std::vector<std::string>& names) override {
    std::vector<TaskReport> reports;
    for (const std::string& name : names) {
      const std::vector<TaskReport> more = show({"-J", name});
      reports.insert(reports.end(), more.begin(), more.end());
    }
    return reports;
  }

  std::vector<TaskReport> look_up(const std::string& /*name*/, const std::string& job) override {
    if (job.empty()) return {};
    return show({job});
  }

  void cancel(const std::string& name) override {
    const CommandAnswer answer = ask_scheduler({"bkill", "-J", name, "0"}, nullptr);
    if (!answer.is_done && !is_unknown(answer)) refuse_answer("bkill", answer);
  }

  std::string number_variable() const override { return "LSB_JOBINDEX"; }

 private:
  std::vector<TaskReport> show(const std::vector<std::string>& which) {
    std::vector<std::string> call{"bjobs", "-a", "-noheader", "-o",
                                  "name jobindex stat exec_host exit_reason delimiter='|'"};
    call.insert(call.end(), which.begin(), which.end());
    const CommandAnswer answer = ask_scheduler(call, stop_);
    if (!answer.is_done && !is_unknown(answer)) throw SchedulerSilent(fmt::format("bjobs says: {}", answer.error));
    return read_bjobs(answer.output);
  }
  SchedulerOptions options_;
  const std::atomic<bool>* stop_;
};

}  // namespace

std::string read_bsub(std::string_view output) {
  constexpr std::string_view k_head = "Job <";
  const std::size_t begin = output.find(k_head);
  if (begin == std::string_view::npos) return "";
  const std::string_view rest = output.substr(begin + k_head.size());
  return std::string(rest.substr(0, rest.find('>')));
}

std::vector<TaskReport> read_bjobs(std::string_view output) {
  std::vector<TaskReport> reports;
  for (const auto& [task, fields] : task_rows(output)) {
    const std::string& state = fields[2];
    TaskReport report{.array = fields[0].substr(0, fields[0].find('[')),
                      .task = task,
                      .node = fields[3] == "-" ? "" : fields[3],
                      .words = state};
    if (state == "DONE" || state == "EXIT" || state == "ZOMBI") {
      report.state = TaskReport::State::ended;
      report.is_success = state == "DONE";
      if (fields[4] != "-" && !fields[4].empty()) report.words = fields[4];  // "TERM_RUNLIMIT: ..."
    } else if (state == "RUN" || state == "SSUSP" || state == "USUSP" || state == "UNKWN") {
      report.state = TaskReport::State::running;
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

std::unique_ptr<Scheduler> make_lsf(const SchedulerOptions& options, const std::atomic<bool>* stop) {
  return std::make_unique<LsfScheduler>(options, stop);
}

}  // namespace mottle::drivers
