// PBS Professional and OpenPBS: qsub, qselect, qstat, qdel.
#include <algorithm>
#include <map>

#include "drivers/scheduler/scheduler_call.hpp"
#include "mottle/core/text.hpp"

namespace mottle::drivers {
namespace {

std::vector<std::string> lines_of_text(std::string_view text) {
  std::vector<std::string> lines = split_text(text, '\n');
  std::erase(lines, "");
  return lines;
}

/// Whether qstat or qdel only misses a job that has ended meanwhile.
bool is_of_ended_job(const CommandAnswer& answer) {
  return answer.error.find("Unknown Job") != std::string::npos ||
         answer.error.find("has finished") != std::string::npos;
}

class PbsScheduler final : public Scheduler {
 public:
  PbsScheduler(SchedulerOptions options, const std::atomic<bool>* stop) : options_(std::move(options)), stop_(stop) {}

  std::string submit(const ArrayRequest& request) override {
    std::vector<std::string> call{"qsub", "-N",        request.name, "-V",
                                  "-r",   "y",         "-j",         "oe",
                                  "-o",   "/dev/null", "-l",         fmt::format("select=1:ncpus={}", options_.cores)};
    const auto add = [&](const std::string& option, const std::string& value) {
      call.insert(call.end(), {option, value});
    };
    if (request.tasks > 1) {  // an array of one is refused
      add("-J", fmt::format("1-{}{}", request.tasks, request.limit > 0 ? fmt::format("%{}", request.limit) : ""));
    }
    if (!options_.partition.empty()) add("-q", options_.partition);
    if (!options_.account.empty()) add("-A", options_.account);
    if (options_.time.count() > 0) add("-l", "walltime=" + clock_text(options_.time));
    if (!options_.licences.empty()) add("-l", licence_assignment(options_.licences));
    call.insert(call.end(), options_.extra.begin(), options_.extra.end());
    call.push_back(request.script.string());
    const CommandAnswer answer = ask_scheduler(call, stop_);
    if (!answer.is_done) refuse_answer("qsub", answer);
    return job_number(answer.output);
  }

  std::vector<TaskReport> list(const std::vector<std::string>& names) override {
    std::vector<std::string> ids;
    for (const std::string& name : names) {
      const std::vector<std::string> more = ids_of(name);
      ids.insert(ids.end(), more.begin(), more.end());
    }
    if (ids.empty()) return {};
    return show(ids, names);
  }

  std::vector<TaskReport> look_up(const std::string& name, const std::string& job) override {
    if (job.empty()) return {};
    return show({job}, {name});
  }

  void cancel(const std::string& name) override {
    std::vector<std::string> call{"qdel"};
    const std::atomic<bool>* stop = std::exchange(stop_, nullptr);
    const std::vector<std::string> ids = ids_of(name);
    stop_ = stop;
    if (ids.empty()) return;
    call.insert(call.end(), ids.begin(), ids.end());
    const CommandAnswer answer = ask_scheduler(call, nullptr);
    if (!answer.is_done && !is_of_ended_job(answer)) refuse_answer("qdel", answer);
  }

  std::string number_variable() const override { return "PBS_ARRAY_INDEX"; }

 private:
  std::vector<TaskReport> show(const std::vector<std::string>& ids, const std::vector<std::string>& names) {
    const CommandAnswer answer = ask_with_history({"qstat", "-t", "-f"}, ids);
    const bool is_over = is_of_ended_job(answer);
    if (!answer.is_done && !is_over) throw SchedulerSilent(fmt::format("qstat says: {}", answer.error));
    if (is_over && answer.output.empty()) return {};
    return read_qstat(answer.output, names);
  }
  /// Of jobs that have ended too (-x), where the server keeps a history; where it does not, they are not shown any
  /// more.
  CommandAnswer ask_with_history(std::vector<std::string> call, const std::vector<std::string>& ids) {
    const auto asked = [&](bool is_history) {
      std::vector<std::string> all = call;
      if (is_history) all.insert(all.begin() + 1, "-x");
      all.insert(all.end(), ids.begin(), ids.end());
      return ask_scheduler(all, stop_);
    };
    if (has_history_) {
      CommandAnswer answer = asked(true);
      has_history_ = answer.is_done || answer.error.find("history") == std::string::npos;
      if (has_history_) return answer;
    }
    return asked(false);
  }
  std::vector<std::string> ids_of(const std::string& name) {
    const CommandAnswer answer = ask_with_history({"qselect", "-N", name}, {});
    if (!answer.is_done) throw SchedulerSilent(fmt::format("qselect says: {}", answer.error));
    return lines_of_text(answer.output);
  }
  SchedulerOptions options_;
  const std::atomic<bool>* stop_;
  bool has_history_ = true;
};

/// A job as `qstat -f` prints it.
struct PrintedJob {
  std::string id = {};
  std::map<std::string, std::string> values = {};

  /// Empty: there is none.
  std::string text(const char* key) const {
    const auto found = values.find(key);
    return found == values.end() ? "" : found->second;
  }
};

/// "Job Id: 7[1].server", then lines "    name = value", of which long ones go on behind a tab. A variable of the
/// environment may have lines that look alike: of two with one name the first counts.
///
/// Its JSON is not used: where the environment holds functions of a shell, as those of `module`, or numbers like 007,
/// many a PBS prints none that can be read.
std::vector<PrintedJob> printed_jobs(std::string_view output) {
  constexpr std::string_view k_head = "Job Id: ";
  constexpr std::string_view k_margin = "    ";
  constexpr std::string_view k_equals = " = ";
  std::vector<PrintedJob> jobs;
  std::string* last = nullptr;
  for (const std::string& line : lines_of_text(output)) {
    if (line.starts_with(k_head)) {
      jobs.push_back({.id = line.substr(k_head.size())});
      last = nullptr;
    } else if (line.front() == '\t') {
      if (last != nullptr) *last += line.substr(1);
    } else if (const std::size_t equals = line.find(k_equals);
               !jobs.empty() && line.starts_with(k_margin) && equals != std::string::npos) {
      const std::string name = line.substr(k_margin.size(), equals - k_margin.size());
      const auto [place, is_new] = jobs.back().values.emplace(name, line.substr(equals + k_equals.size()));
      last = is_new ? &place->second : nullptr;
    }
  }
  return jobs;
}

TaskReport::State state_of(const std::string& letter) {
  if (letter == "F" || letter == "X") return TaskReport::State::ended;
  return letter == "R" || letter == "E" || letter == "S" || letter == "U" ? TaskReport::State::running
                                                                          : TaskReport::State::waiting;
}

}  // namespace

std::vector<TaskReport> read_qstat(std::string_view output, const std::vector<std::string>& names) {
  const std::vector<PrintedJob> jobs = printed_jobs(output);
  if (jobs.empty() && !output.empty()) throw SchedulerSilent("qstat printed something else than a list of jobs");
  std::vector<TaskReport> reports;
  for (const PrintedJob& job : jobs) {
    const std::string name = job.text("Job_Name");
    if (std::ranges::find(names, name) == names.end()) continue;
    const std::size_t bracket = job.id.find('[');
    double number = 1.0;  // a job that is no array
    if (bracket != std::string::npos &&
        !parse_number(job.id.substr(bracket + 1, job.id.find(']') - bracket - 1), number)) {
      continue;  // "12[].server" is the array itself
    }
    const std::string letter = job.text("job_state");
    const std::string status = job.text("Exit_status");
    const std::string host = job.text("exec_host");
    TaskReport report{.array = name,
                      .task = static_cast<int>(number),
                      .state = state_of(letter),
                      .node = host.substr(0, host.find('/')),
                      .words = job.text("comment")};
    if (report.words.empty()) report.words = letter;
    if (report.state == TaskReport::State::ended) {
      report.is_success = status.empty() || status == "0";
      if (!report.is_success) report.words += fmt::format(" (exit status {})", status);
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

std::unique_ptr<Scheduler> make_pbs(const SchedulerOptions& options, const std::atomic<bool>* stop) {
  return std::make_unique<PbsScheduler>(options, stop);
}

}  // namespace mottle::drivers
