// [model] of kind "command": a solver that is run by its command.
#include "study/models/command/read_command.hpp"

#include <algorithm>
#include <charconv>
#include <set>

#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/number_pattern.hpp"
#include "study/input/durations.hpp"

namespace mottle::study {
namespace {

constexpr OptionRange k_any_count{.lower = 1.0, .upper = 1e6};

/// A list of texts as they are; of a shell one text.
CommandLine read_line(TomlReader& reader, const std::string& key) {
  CommandLine line{.arguments = reader.texts(key)};
  line.is_shell = reader.raw(key)->is_string();
  if (line.arguments.front().empty()) reader.fail_value(key, "a program and its arguments, like [\"ccx\", \"plate\"]");
  return line;
}

/// Files of the study by the names that they have in a run's folder: their own where they lie in the study's folder,
/// else the last part. Of templates ".in" and ".template" go.
std::vector<RunFile> read_run_files(TomlReader& reader, const std::string& key, const std::filesystem::path& folder,
                                    bool are_templates, std::set<std::string>& taken) {
  std::vector<RunFile> files;
  if (!reader.has(key)) {
    reader.raw(key);
    return files;
  }
  for (const std::string& text : reader.texts(key)) {
    const std::filesystem::path given = std::filesystem::path(text).lexically_normal();
    const bool is_below = given.is_relative() && *given.begin() != "..";
    std::filesystem::path name = is_below ? given : given.filename();
    if (are_templates && (name.extension() == ".in" || name.extension() == ".template")) name.replace_extension();
    if (name.empty()) reader.fail_value(key, "names of files");
    if (!taken.insert(name.string()).second) {
      reader.fail(key, fmt::format("two files would be called '{}' in a run's folder", name.string()));
    }
    files.push_back({folder / text, name.string()});
  }
  return files;
}

/// A file that a run leaves in its folder: elsewhere it could be that of another run.
std::string read_output_name(TomlReader& reader) {
  std::string name = reader.text("file");
  const std::filesystem::path path = std::filesystem::path(name).lexically_normal();
  if (path.is_absolute() || path.empty() || *path.begin() == "..") {
    reader.fail_value("file", "the name of a file that each run leaves in its own folder");
  }
  return name;
}

/// What the formats "column" and "regex" and so on need; a key that the format does not use is unknown.
FrequencyRule read_frequency_rule(TomlReader reader) {
  using Format = FrequencyRule::Format;
  using Quantity = FrequencyRule::Quantity;
  FrequencyRule rule;
  rule.file = read_output_name(reader);
  reader.text("format");
  rule.format = std::vector{Format::column, Format::regex, Format::csv,     Format::json,
                            Format::f06,    Format::punch, Format::calculix}[reader.choice(
      "format", {"column", "regex", "csv", "json", "f06", "punch", "calculix"}, 0)];
  if (!rule.has_eigenvalues()) {
    rule.quantity = std::vector{Quantity::hertz, Quantity::radians,
                                Quantity::eigenvalue}[reader.choice("quantity", {"Hz", "rad/s", "eigenvalue"}, 0)];
  }
  rule.modes = static_cast<int>(reader.integer_or("modes", 0, k_any_count));
  if (rule.format == Format::regex) {
    rule.pattern = reader.text("pattern");
    try {
      const NumberPattern pattern(rule.pattern);
    } catch (const InvalidInput& error) {
      reader.fail("pattern", error.what());
    }
  } else if (rule.format == Format::column) {
    rule.after = reader.text_or("after", "");
    rule.line = static_cast<int>(reader.integer_or("line", 1, k_any_count));
    rule.column = fmt::format("{}", reader.integer_or("column", 1, k_any_count));
  } else if (rule.format == Format::csv || rule.format == Format::json) {
    rule.column = reader.text("column");
  }
  reader.finish();
  return rule;
}

ShapeRule read_shape_rule(TomlReader reader) {
  using Format = ShapeRule::Format;
  ShapeRule rule;
  rule.file = read_output_name(reader);
  reader.text("format");
  rule.format =
      std::vector{Format::csv, Format::column, Format::f06, Format::punch,
                  Format::calculix}[reader.choice("format", {"csv", "column", "f06", "punch", "calculix"}, 0)];
  if (rule.format == Format::column) {
    rule.after = reader.text("after");
    if (rule.after.empty()) reader.fail_value("after", "a text that stands before the table of each mode");
    rule.line = static_cast<int>(reader.integer_or("line", 1, k_any_count));
    if (reader.has("components"))
      rule.components = reader.texts("components");
    else
      reader.raw("components");
  }
  reader.finish();
  return rule;
}

std::map<std::string, std::string> read_environment(TomlReader reader) {
  std::map<std::string, std::string> environment;
  for (const std::string& name : reader.keys()) {
    if (name.empty() || name.find('=') != std::string::npos) reader.fail(name, "is no name of a variable");
    environment[name] = reader.text(name);
  }
  return environment;
}

/// "ansys" or "ansys:2".
std::string read_licences(TomlReader& reader) {
  std::string licences = reader.text_or("licences", "");
  const std::size_t colon = licences.find(':');
  const std::string count = colon == std::string::npos ? "1" : licences.substr(colon + 1);
  const bool is_count = !count.empty() && count.find_first_not_of("0123456789") == std::string::npos;
  if (reader.has("licences") && (licences.empty() || colon == 0 || !is_count)) {
    reader.fail_value("licences", "a name of the scheduler's with a number, like \"ansys:1\"");
  }
  return licences;
}

/// Texts that become words of the scheduler's command, which control characters would end or split.
void require_one_line(TomlReader& reader, const char* key, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (std::ranges::none_of(text, is_control)) continue;
    reader.fail(key, fmt::format("holds a line break or another control character, and is a word of the scheduler's "
                                 "command; found '{}'",
                                 printable(text)));
  }
}

SchedulerOptions read_scheduler(TomlReader reader, SchedulerKind kind) {
  constexpr OptionRange k_count{.lower = 1.0, .upper = 1e6};
  SchedulerOptions options{.kind = kind};
  options.partition = reader.text_or("partition", "");
  options.account = reader.text_or("account", "");
  require_one_line(reader, "partition", {options.partition});
  require_one_line(reader, "account", {options.account});
  if (reader.has("time")) options.time = read_duration(reader, "time", options.time);
  reader.raw("time");
  options.cores = static_cast<int>(reader.integer_or("cores", options.cores, k_count));
  options.runs_at_once = static_cast<int>(reader.integer_or("runs_at_once", 0, {.lower = 0.0, .upper = 1e6}));
  options.licences = read_licences(reader);
  require_one_line(reader, "licences", {options.licences});
  options.runs_per_task = static_cast<int>(reader.integer_or("runs_per_task", 0, {.lower = 0.0, .upper = 1e6}));
  options.tries = static_cast<int>(reader.integer_or("tries", options.tries, {.lower = 1.0, .upper = 100.0}));
  if (reader.has("extra")) options.extra = reader.texts("extra");
  require_one_line(reader, "extra", options.extra);
  for (const std::string& option : options.extra) {
    const bool is_array = option.starts_with("-J") || option.starts_with("--array") ||
                          (kind == SchedulerKind::slurm && option.starts_with("-a"));
    const bool is_name = option.starts_with("--job-name") || (kind == SchedulerKind::pbs && option.starts_with("-N"));
    if (is_name || is_array) {
      reader.fail(
          "extra",
          fmt::format("names and arrays of jobs are Mottle's, which finds its tasks by them; found '{}'", option));
    }
  }
  reader.raw("extra");
  reader.finish();
  return options;
}

/// model.launch, and what its scheduler is told.
void read_launch(TomlReader& reader, SolverCommand& command) {
  const std::vector<std::string> names{"local", "slurm", "pbs", "lsf", "mpi"};
  const std::string launch = names[reader.choice("launch", names, 0)];
  command.needs_ranks = launch == "mpi";
  const bool is_scheduled = launch == "slurm" || launch == "pbs" || launch == "lsf";
  if (reader.has("scheduler") && !is_scheduled) {
    reader.fail("scheduler",
                fmt::format("is for model.launch = \"slurm\", \"pbs\" or \"lsf\"; found launch = \"{}\"", launch));
  }
  if (!is_scheduled) return;
  if (reader.has("parallel")) {
    reader.fail("parallel", "is for runs on this machine; say scheduler.runs_at_once in its place");
  }
  const SchedulerKind kind = launch == "slurm" ? SchedulerKind::slurm
                             : launch == "pbs" ? SchedulerKind::pbs
                                               : SchedulerKind::lsf;
  command.scheduler = SchedulerOptions{.kind = kind};
  if (reader.raw("scheduler") != nullptr) command.scheduler = read_scheduler(reader.table("scheduler"), kind);
}

}  // namespace

SolverCommand read_command(TomlReader& reader, const std::filesystem::path& folder) {
  SolverCommand command;
  std::set<std::string> taken{"stdout.txt", "stderr.txt", "reason.txt"};
  command.templates = read_run_files(reader, "templates", folder, true, taken);
  command.files = read_run_files(reader, "files", folder, false, taken);
  command.command = read_line(reader, "command");
  if (reader.raw("retry_command") != nullptr) command.retry_command = read_line(reader, "retry_command");
  const int usual_retries = command.retry_command ? 1 : 0;
  command.retries = static_cast<int>(reader.integer_or("retries", usual_retries, {.lower = 0.0, .upper = 100.0}));
  if (command.retry_command && command.retries == 0) reader.fail("retry_command", "is never used with retries = 0");
  command.timeout = read_duration(reader, "timeout", command.timeout);
  command.parallel = static_cast<int>(reader.integer_or("parallel", 1, {.lower = 1.0, .upper = 1000.0}));
  read_launch(reader, command);
  if (reader.raw("environment") != nullptr) command.environment = read_environment(reader.table("environment"));
  command.kept =
      std::vector{KeptRuns::failed, KeptRuns::none, KeptRuns::all}[reader.choice("keep", {"failed", "none", "all"}, 0)];
  command.max_failed_fraction =
      reader.number_or("largest_failed_part", command.max_failed_fraction, {.lower = 0.0, .upper = 1.0});
  command.difference_step = reader.number_or("difference_step", command.difference_step, {.lower = 1e-6, .upper = 1.0});
  command.frequencies = read_frequency_rule(reader.table("frequencies"));
  if (reader.raw("shapes") != nullptr) command.shapes = read_shape_rule(reader.table("shapes"));
  return command;
}

}  // namespace mottle::study
