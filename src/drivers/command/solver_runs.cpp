#include "mottle/drivers/command/solver_runs.hpp"

#include <algorithm>
#include <functional>
#include <thread>

#include "drivers/command/run_output.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/solver_process.hpp"

namespace mottle::drivers {
namespace {

/// Appends a piece so that no two lists of pieces give the same text.
void add_piece(std::string& text, std::string_view piece) {
  text += fmt::format("{}:", piece.size());
  text += piece;
}

std::string rules_text(const SolverCommand& command) {
  const FrequencyRule& f = command.frequencies;
  std::string text = fmt::format("{} {} {} {} {} ", static_cast<int>(f.format), static_cast<int>(f.quantity), f.line,
                                 f.modes, command.retries);
  for (const std::string* piece : {&f.file, &f.pattern, &f.after, &f.column}) add_piece(text, *piece);
  if (command.shapes) {
    const ShapeRule& s = *command.shapes;
    text += fmt::format("{} {} ", static_cast<int>(s.format), s.line);
    for (const std::string* piece : {&s.file, &s.after}) add_piece(text, *piece);
    for (const std::string& component : s.components) add_piece(text, component);
  }
  return text;
}

std::string joined(const CommandLine& line) {
  return join(line.arguments, " ");
}

}  // namespace

SolverRuns::SolverRuns(SolverCommand command, const std::vector<std::string>& names, const RunStorage& storage)
    : command_(std::move(command)), names_(names), is_resumed_(storage.is_resumed), is_task_(storage.is_task) {
  read_templates();
  if (!command_.scheduler) {  // what nodes of a cluster have, they know themselves
    require_program(command_.command);
    if (command_.retry_command) require_program(*command_.retry_command);
  }
  const int rank = storage.ranks == nullptr ? 0 : storage.ranks->rank();
  const int ranks = storage.ranks == nullptr ? 1 : storage.ranks->count();
  folders_ = std::make_unique<RunFolders>(storage.results, !storage.is_resumed && rank == 0);
  read_files();
  if (storage.results.empty()) return;
  const RunStoreFiles files = run_store_files(storage.results, rank, ranks);
  store_ = std::make_unique<RunStore>(files.own, files.others);
}

void SolverRuns::read_templates() {
  for (RunFile& file : command_.templates) {
    if (!file.text) file.text = read_file(file.source);
    templates_.emplace_back(*file.text, file.source.string(), names_);
    add_piece(constants_, file.name);
  }
  for (const std::string& argument : command_.command.arguments) {
    arguments_.emplace_back(argument, "model.command", names_);
  }
  if (command_.retry_command) {
    for (const std::string& argument : command_.retry_command->arguments) {
      retry_arguments_.emplace_back(argument, "model.retry_command", names_);
    }
  }
  std::vector<bool> used(names_.size());
  for (const std::vector<Template>* list : {&templates_, &arguments_}) {
    for (const Template& text : *list) {
      const std::vector<bool> here = text.uses(names_.size());
      std::transform(used.begin(), used.end(), here.begin(), used.begin(), std::logical_or<>());
    }
  }
  for (std::size_t i = 0; i < names_.size(); ++i) {
    require_of(used[i], subject_parameter(names_[i]),
               "acts on nothing: {{{{{}}}}} stands in no template and not in the command", names_[i]);
  }
  add_piece(constants_, rules_text(command_));
  for (const auto& [name, value] : command_.environment) add_piece(constants_, fmt::format("{}={}", name, value));
}

void SolverRuns::require_program(const CommandLine& line) const {
  const std::string& program = line.arguments.front();
  if (line.is_shell || program.find("{{") != std::string::npos) return;
  if (program.find('/') == std::string::npos) {
    require_of(!find_program(program).empty(), {Subject::Kind::command}, "there is no program '{}' on PATH", program);
    return;
  }
  const auto is_meant = [&](const RunFile& file) {
    return std::filesystem::path(program).lexically_normal() == file.name;
  };
  const bool is_own = std::any_of(command_.files.begin(), command_.files.end(), is_meant) ||
                      std::any_of(command_.templates.begin(), command_.templates.end(), is_meant);
  require_of(is_own || (std::filesystem::path(program).is_absolute() && std::filesystem::exists(program)),
             {Subject::Kind::command},
             "'{}' is not there; give a program on PATH, an absolute path, or one of the files of a run as ./NAME",
             program);
}

void SolverRuns::read_files() {
  files_ = std::make_unique<InputFiles>(command_.files, folders_->shared());
  for (std::size_t i = 0; i < command_.files.size(); ++i) {
    add_piece(constants_, command_.files[i].name);
    add_piece(constants_, hexadecimal(files_->digests()[i]));
  }
}

SolverRuns::Input SolverRuns::fill(const Eigen::Ref<const Eigen::VectorXd>& values) const {
  Input input;
  for (const Template& text : templates_) input.texts.push_back(text.fill(values));
  for (const Template& text : arguments_) input.arguments.push_back(text.fill(values));
  for (const Template& text : retry_arguments_) input.retry_arguments.push_back(text.fill(values));
  return input;
}

Digest SolverRuns::key_of(const Input& input, int min_modes) const {
  std::string text = constants_ + fmt::format("{} {} ", min_modes, command_.command.is_shell);
  for (const auto* list : {&input.texts, &input.arguments, &input.retry_arguments}) {
    text += fmt::format("[{}]", list->size());
    for (const std::string& piece : *list) add_piece(text, piece);
  }
  Checksum sum;
  sum.add(text);
  return sum.digest();
}

SolverRuns::Run SolverRuns::run(const Eigen::Ref<const Eigen::VectorXd>& values, int min_modes,
                                const std::atomic<bool>* stop) {
  const Input input = fill(values);
  const Digest key = key_of(input, min_modes);
  Run run;
  if (std::optional<RunRecord> known = find(key)) {
    run.record = std::move(*known);
    run.is_reused = true;
    return run;
  }
  const std::string id = id_of(key);
  std::filesystem::path folder;
  const bool is_done = try_until_done(input, min_modes, stop, folder, run);
  if (!is_done) {
    run.record.failure += fmt::format(" ({}run {})", run.tries > 1 ? fmt::format("{} tries, ", run.tries) : "", id);
  }
  put_away(folder, id, run);
  if (run.losses < k_max_losses) keep(key, run.record);  // of one that others have ended nothing is known
  return run;
}

Digest SolverRuns::key_at(const Eigen::Ref<const Eigen::VectorXd>& values, int min_modes) const {
  return key_of(fill(values), min_modes);
}

void SolverRuns::begin_batch() const {
  if (store_) store_->look_at_others();
}

std::optional<RunRecord> SolverRuns::find(const Digest& key) const {
  if (!store_) return std::nullopt;
  std::optional<RunRecord> known = store_->find(key);
  // A failure of this job counts whether it is resumed or not.
  if (known && (known->failure.empty() || is_resumed_ || store_->is_new(key))) return known;
  return std::nullopt;
}

void SolverRuns::keep(const Digest& key, const RunRecord& record) {
  if (store_) store_->keep(key, record);
}

void SolverRuns::flush() {
  if (store_) store_->flush();
}

std::filesystem::path SolverRuns::keep_folder(const std::filesystem::path& folder, bool has_failed,
                                              const std::string& name) {
  return folders_->keep(folder, has_failed, name);
}

Digest SolverRuns::constants() const {
  std::string text = constants_ + fmt::format("{} ", command_.command.is_shell);
  for (const RunFile& file : command_.templates) add_piece(text, *file.text);
  for (const std::string& argument : command_.command.arguments) add_piece(text, argument);
  if (command_.retry_command) {
    for (const std::string& argument : command_.retry_command->arguments) add_piece(text, argument);
  }
  return digest_of(text);
}

std::string SolverRuns::id_of(const Digest& key) {
  return hexadecimal(key).substr(0, 12);
}

void SolverRuns::keep_as(const Eigen::Ref<const Eigen::VectorXd>& values, int min_modes, const RunRecord& record) {
  if (!store_) return;
  const Digest key = key_of(fill(values), min_modes);
  if (!store_->find(key)) store_->keep(key, record);
}

std::string SolverRuns::command_text() const {
  return joined(command_.command);
}

SolverCommand SolverRuns::frozen_command() const {
  SolverCommand frozen = command_;
  for (std::vector<RunFile>* list : {&frozen.templates, &frozen.files}) {
    for (RunFile& file : *list) file.source = std::filesystem::absolute(file.source);
  }
  return frozen;
}

std::vector<std::string> SolverRuns::coarse_placeholders(const Eigen::Ref<const Eigen::VectorXd>& values,
                                                         const Eigen::Ref<const Eigen::VectorXd>& steps) const {
  std::vector<std::string> placeholders;
  for (const std::vector<Template>* list : {&templates_, &arguments_}) {
    for (const Template& text : *list) {
      for (std::string& placeholder : text.coarse_placeholders(values, steps))
        placeholders.push_back(std::move(placeholder));
    }
  }
  return placeholders;
}

}  // namespace mottle::drivers
