// PBS Professional and OpenPBS: qsub, qselect, qstat, qdel.
#include <algorithm>
#include <nlohmann/json.hpp>

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
    return answer.output.substr(0, answer.output.find('\n'));
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
    const CommandAnswer answer = ask_with_history({"qstat", "-t", "-f", "-F", "json"}, ids);
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

/// A text of a job; empty: there is none.
std::string text_of(const nlohmann::json& job, const char* key) {
  return job.contains(key) && job[key].is_string() ? job[key].get<std::string>() : "";
}

TaskReport::State state_of(const std::string& letter) {
  if (letter == "F" || letter == "X") return TaskReport::State::ended;
  return letter == "R" || letter == "E" || letter == "S" || letter == "U" ? TaskReport::State::running
                                                                          : TaskReport::State::waiting;
}

}  // namespace

std::vector<TaskReport> read_qstat(const std::string& output, const std::vector<std::string>& names) {
  std::vector<TaskReport> reports;
  const nlohmann::json root = nlohmann::json::parse(output, nullptr, false);
  if (!root.is_object()) throw SchedulerSilent("qstat printed something else than JSON of jobs");
  const nlohmann::json jobs = root.contains("Jobs") ? root["Jobs"] : nlohmann::json::object();
  if (!jobs.is_object()) throw SchedulerSilent("qstat printed no table of jobs");
  for (const auto& [id, job] : jobs.items()) {
    if (!job.is_object()) continue;
    const std::string name = text_of(job, "Job_Name");
    if (std::ranges::find(names, name) == names.end()) continue;
    const std::size_t bracket = id.find('[');
    double number = 1.0;  // a job that is no array
    if (bracket != std::string::npos && !parse_number(id.substr(bracket + 1, id.find(']') - bracket - 1), number)) {
      continue;  // "12[].server" is the array itself
    }
    const std::string letter = text_of(job, "job_state");
    const int status =
        job.contains("Exit_status") && job["Exit_status"].is_number() ? job["Exit_status"].get<int>() : 0;
    TaskReport report{.array = name,
                      .task = static_cast<int>(number),
                      .state = state_of(letter),
                      .node = text_of(job, "exec_host"),
                      .words = text_of(job, "comment")};
    if (report.words.empty()) report.words = letter;
    report.node = report.node.substr(0, report.node.find('/'));
    if (report.state == TaskReport::State::ended) {
      report.is_success = status == 0;
      if (status != 0) report.words += fmt::format(" (exit status {})", status);
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

std::unique_ptr<Scheduler> make_pbs(const SchedulerOptions& options, const std::atomic<bool>* stop) {
  return std::make_unique<PbsScheduler>(options, stop);
}

}  // namespace mottle::drivers
