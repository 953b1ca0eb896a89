// Description of a solver that is run by its command, as plain data: input files, command line, rules for its output.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mottle/drivers/command/extraction.hpp"
#include "mottle/drivers/scheduler/scheduler_options.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::drivers {

/// A file of the study and its name in a run's folder.
struct RunFile {
  std::filesystem::path source;
  std::string name;
  std::optional<std::string> text = std::nullopt;  ///< what it holds, in place of the source's bytes
};

/// The program and its arguments, each with placeholders for parameters; of a shell one text.
struct CommandLine {
  std::vector<std::string> arguments = {};
  bool is_shell = false;
};

/// Which folders of runs stay.
enum class KeptRuns { none, failed, all };

struct SolverCommand {
  std::vector<RunFile> templates = {};  ///< with placeholders for parameters
  std::vector<RunFile> files = {};      ///< as they are
  CommandLine command = {};
  std::optional<CommandLine> retry_command = std::nullopt;  ///< in place of the command from the second try on
  int retries = 0;
  std::chrono::milliseconds timeout = std::chrono::hours(24);
  int parallel = 1;  ///< runs at once; also what the licences allow
  std::map<std::string, std::string> environment = {};
  KeptRuns kept = KeptRuns::failed;
  double max_failed_fraction = 0.25;                  ///< of 20 runs or more; above it all runs stop
  double difference_step = k_coarse_difference_step;  ///< in prior standard deviations
  FrequencyRule frequencies = {};
  std::optional<ShapeRule> shapes = std::nullopt;
  std::optional<SchedulerOptions> scheduler = std::nullopt;  ///< that does the runs; none: this machine
  bool needs_ranks = false;                                  ///< by the study's word, several ranks share the runs
};

}  // namespace mottle::drivers
