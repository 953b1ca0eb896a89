// The tries of a run by SolverRuns: input, solver, result, and what stays of its folder.
#include <thread>

#include "drivers/command/run_output.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/solver_process.hpp"
#include "mottle/drivers/command/solver_runs.hpp"

namespace mottle::drivers {
namespace {

std::vector<std::string> for_process(const std::vector<std::string>& arguments, bool is_shell) {
  if (!is_shell) return arguments;
  return {"/bin/sh", "-c", arguments.front()};
}

}  // namespace

void SolverRuns::prepare(const std::filesystem::path& folder, const Input& input) const {
  std::error_code error;
  for (std::size_t i = 0; i < input.texts.size(); ++i) {
    const std::filesystem::path file = folder / command_.templates[i].name;
    std::filesystem::create_directories(file.parent_path(), error);
    write_run_file(file, input.texts[i]);
    std::filesystem::permissions(file, std::filesystem::status(command_.templates[i].source, error).permissions(),
                                 error);
  }
  files_->put_into(folder);
}

bool SolverRuns::try_once(const Input& input, const std::filesystem::path& folder, int number, int min_modes,
                          const std::atomic<bool>* stop, Run& run) const {
  const bool is_other = number > 0 && command_.retry_command;
  prepare(folder, input);
  const ProcessEnd end =
      run_process({.arguments = for_process(is_other ? input.retry_arguments : input.arguments,
                                            is_other ? command_.retry_command->is_shell : command_.command.is_shell),
                   .directory = folder,
                   .environment = command_.environment,
                   .timeout = command_.timeout,
                   .stop = stop});
  if (end.kind == ProcessEnd::Kind::stopped) throw Stopped("stopped on request");
  files_->require_unchanged();
  if (!folders_->recover(folder)) {
    run.record = {.failure = "the run took away the folder that it ran in"};
    return false;
  }
  folders_->require_room(folder);
  run.record = {.failure = end.reason};
  if (end.kind == ProcessEnd::Kind::failed) require_own_failure(stop);
  if (end.kind == ProcessEnd::Kind::lost) {
    ++run.losses;
    return false;
  }
  const bool is_done = end.kind == ProcessEnd::Kind::done && read_result(folder, min_modes, run.record);
  if (end.was_full || (!is_done && tells_of_full_disk(folder, given_names()))) {
    throw NoRoom(
        fmt::format("{}: the disk was full while the solver was at work there; what it left is not used, "
                    "finished runs are kept: make room and go on with --resume",
                    folder.string()));
  }
  return is_done;
}

std::set<std::string> SolverRuns::given_names() const {
  std::set<std::string> names;
  for (const std::vector<RunFile>* list : {&command_.templates, &command_.files}) {
    for (const RunFile& file : *list) names.insert(file.name);
  }
  return names;
}

bool SolverRuns::read_result(const std::filesystem::path& folder, int min_modes, RunRecord& record) const {
  try {
    record.modes = extract_modes(folder, command_.frequencies, command_.shapes, min_modes);
    return true;
  } catch (const InvalidInput& error) {
    record.failure = error.what();
    return false;
  }
}

/// Tries whose guard was ended from outside are made again, and are none of the allowed ones.
bool SolverRuns::try_until_done(const Input& input, int min_modes, const std::atomic<bool>* stop,
                                std::filesystem::path& folder, Run& run) const {
  for (int number = 0; number <= command_.retries;) {
    if (!folder.empty()) folders_->remove(folder);
    folder = folders_->make();
    const int losses = run.losses;
    const bool is_done = try_once(input, folder, number, min_modes, stop, run);
    ++run.tries;
    if (is_done) return true;
    const bool is_lost = run.losses > losses;
    if (is_lost && run.losses >= k_max_losses) return false;
    if (!is_lost) ++number;
  }
  return false;
}

/// A scheduler signals all processes of a task, the solver perhaps before Mottle: such an end says nothing of the run.
void SolverRuns::require_own_failure(const std::atomic<bool>* stop) const {
  constexpr int k_looks = 100;
  constexpr std::chrono::milliseconds k_between{10};
  for (int look = 0; is_task_ && stop != nullptr && look < k_looks; ++look) {
    if (stop->load()) throw Stopped("stopped on request");
    std::this_thread::sleep_for(k_between);
  }
}

void SolverRuns::put_away(const std::filesystem::path& folder, const std::string& id, Run& run) {
  const bool has_failed = !run.record.failure.empty();
  constexpr std::size_t k_longest_failure = 600;
  run.record.failure = shortened(printable(run.record.failure), k_longest_failure);
  if (!folders_->recover(folder)) return;
  if (has_failed) run.last_words = printable(last_words(folder));
  if (command_.kept == KeptRuns::none || (command_.kept == KeptRuns::failed && !has_failed)) {
    folders_->remove(folder);
    return;
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder / "reason.txt", ignored);  // which may be a link out of the folder
  if (has_failed) write_run_file(folder / "reason.txt", run.record.failure + '\n');
  files_->relink(folder);
  shorten_output(folder);
  run.folder = folders_->keep(folder, has_failed, id);
}

}  // namespace mottle::drivers
