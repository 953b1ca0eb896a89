// mottle status, mottle cancel: tasks of a scheduler that do a folder's runs; mottle run-task: what such a task does.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "common_options.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/drivers/scheduler/task_status.hpp"
#include "mottle/drivers/scheduler/task_worker.hpp"

namespace mottle::app {
namespace {

using drivers::ArrayStatus;
using drivers::TaskReport;

void require_folder(const std::filesystem::path& folder) {
  require(std::filesystem::is_directory(folder), "{}: is no folder of results; name the one that --out named",
          folder.string());
}

/// Status and message of a result that is there; null: none is.
nlohmann::json result_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "result.json";
  if (!std::filesystem::is_regular_file(file)) return nullptr;
  const std::string bytes = read_file(file);
  if (nests_deeper_than(bytes, k_deepest_json)) return nullptr;
  const nlohmann::json result = nlohmann::json::parse(bytes, nullptr, false);
  if (!result.is_object()) return nullptr;
  nlohmann::json shown;
  for (const char* key : {"title", "status", "message"}) {
    if (result.contains(key) && result[key].is_string()) shown[key] = result[key];
  }
  return shown;
}

const char* state_text(TaskReport::State state) {
  return state == TaskReport::State::waiting ? "waiting" : state == TaskReport::State::running ? "running" : "ended";
}

nlohmann::json json_of(const ArrayStatus& array) {
  nlohmann::json tasks = nlohmann::json::array();
  for (const TaskReport& report : array.reports) {
    tasks.push_back({{"task", report.task},
                     {"state", state_text(report.state)},
                     {"node", printable(report.node)},
                     {"scheduler_says", printable(report.words)}});
  }
  return {{"name", array.name},
          {"job", printable(array.job)},
          {"scheduler", drivers::scheduler_name(array.kind)},
          {"tasks", array.tasks},
          {"waiting", array.waiting},
          {"running", array.running},
          {"ended", array.ended},
          {"runs", array.runs},
          {"done", array.done},
          {"failed", array.failed},
          {"no_answer", printable(array.silence)},
          {"task_list", std::move(tasks)}};
}

void print_array(const ArrayStatus& array) {
  const std::string job = array.job.empty() ? "" : fmt::format(", job {}", array.job);
  const std::string tasks = array.silence.empty() ? fmt::format("{} tasks: {} waiting, {} running, {} ended",
                                                                array.tasks, array.waiting, array.running, array.ended)
                                                  : fmt::format("{} tasks; {}", array.tasks, array.silence);
  const std::string line = fmt::format("{} ({}{}): {}; {} runs: {} done, {} of them failed, {} to do", array.name,
                                       drivers::scheduler_name(array.kind), job, tasks, array.runs, array.done,
                                       array.failed, array.runs - std::min(array.runs, array.done));
  fmt::print("{}\n", printable(line));
  for (const TaskReport& report : array.reports) {
    if (report.state != TaskReport::State::running) continue;
    fmt::print("{}\n", printable(fmt::format("  task {} runs on {}", report.task, report.node)));
  }
}

void show_status(const std::filesystem::path& folder, bool is_json) {
  require_folder(folder);
  const std::vector<ArrayStatus> arrays = drivers::read_task_status(folder);
  const drivers::StoredRuns stored = drivers::count_stored_runs(folder / drivers::k_run_store);
  const nlohmann::json result = result_of(folder);
  if (is_json) {
    nlohmann::json all{{"arrays", nlohmann::json::array()},
                       {"stored_runs", {{"done", stored.done}, {"failed", stored.failed}}},
                       {"result", result}};
    for (const ArrayStatus& array : arrays) all["arrays"].push_back(json_of(array));
    fmt::print("{}\n", all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  for (const ArrayStatus& array : arrays) print_array(array);
  if (arrays.empty()) fmt::print("no tasks of a scheduler\n");
  if (stored.done > 0) fmt::print("runs.store: {} runs, {} of them failed\n", stored.done, stored.failed);
  if (result.is_null()) {
    fmt::print("no result yet\n");
  } else {
    fmt::print("result.json: {}\n", printable(result.value("status", "") + ": " + result.value("message", "")));
  }
}

}  // namespace

void add_status(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("status", "tasks of a scheduler that do a folder's runs, and how far they are");
  const auto folder = std::make_shared<std::string>();
  const auto is_json = std::make_shared<bool>(false);
  verb->add_option("DIR", *folder, "folder of results")->required();
  verb->add_flag("--json", *is_json, "print one line of JSON");
  verb->callback([folder, is_json] { show_status(*folder, *is_json); });
}

void add_cancel(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("cancel", "end a folder's tasks of a scheduler; --resume goes on later");
  const auto folder = std::make_shared<std::string>();
  verb->add_option("DIR", *folder, "folder of results")->required();
  verb->callback([folder] {
    require_folder(*folder);
    const std::vector<std::string> names = drivers::cancel_tasks(*folder);
    if (names.empty())
      fmt::print("no tasks of a scheduler now; a Mottle that is at work there ends before it submits more\n");
    for (const std::string& name : names) fmt::print("cancelled: {}\n", name);
  });
}

void add_run_task(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("run-task", "do the runs of one task: for the scripts that Mottle submits");
  const auto array = std::make_shared<std::string>();
  const auto task = std::make_shared<int>(0);
  verb->add_option("ARRAY", *array, "folder of the array of tasks")->required();
  verb->add_option("TASK", *task, "number of the task")->required();
  verb->callback([array, task] { drivers::run_task(*array, *task, &stop_flag()); });
  verb->group("");  // not for people
}

}  // namespace mottle::app
