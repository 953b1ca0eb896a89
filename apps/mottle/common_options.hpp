// The options that every study verb has, and what they become.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "console.hpp"
#include "job_ranks.hpp"
#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::app {

/// What --units of a deck may be.
inline const std::vector<std::string>& unit_systems() {
  static const std::vector<std::string> k_systems = {"SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"};
  return k_systems;
}

/// Values of --out, --set, --threads, --seed, --resume, --cache, --no-run, --quiet, --json.
struct CommonOptions {
  std::string study;
  std::string out;
  std::string cache;
  std::vector<std::string> assignments;
  int threads = 0;
  std::optional<std::uint64_t> seed;
  bool resume = false;
  bool runs_nothing = false;
  bool quiet = false;
  bool json = false;
};

/// Adds the study argument and the common options to a verb.
void add_common_options(CLI::App& verb, CommonOptions& options);

/// The folder of --cache; empty: none.
std::filesystem::path cache_folder(const std::string& given);

Study read_study(const CommonOptions& options);

/// @param ranks  that do the job together; null: this process is alone
/// `console` and `ranks` must outlive the settings.
RunSettings run_settings(const CommonOptions& options, Console& console, Ranks* ranks = nullptr);

/// Whether this process does the job with others and is not the first: results and words are the first one's business.
inline bool is_helper(const Ranks* ranks) {
  return ranks != nullptr && !ranks->is_first();
}
/// The job is computed, and the first rank writes it down alone.
inline void go_alone(Ranks* ranks) {
  if (ranks != nullptr) ranks->go_alone();
}

/// Prints the summary, as lines or as JSON.
void print_summary(const CommonOptions& options, const RunSummary& summary);

/// Each verb adds itself; its callback throws what goes wrong.
void add_init(CLI::App& app);
void add_update(CLI::App& app);
void add_diagnose(CLI::App& app);
void add_propagate(CLI::App& app);
void add_simulate(CLI::App& app);
void add_check(CLI::App& app);
void add_modes(CLI::App& app);
void add_targets(CLI::App& app);
void add_report(CLI::App& app);
void add_compare(CLI::App& app);
void add_status(CLI::App& app);
void add_cancel(CLI::App& app);
void add_run_task(CLI::App& app);
void add_export(CLI::App& app);
void add_methods(CLI::App& app);
void add_completion(CLI::App& app);

}  // namespace mottle::app
