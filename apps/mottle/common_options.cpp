#include "common_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "mottle/core/parallel.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::app {
namespace {

/// The user's own cache: neither in the study's folder, which may be read-only or under version control, nor in the
/// results', since other studies of the same model find it there too. Empty where the user has no home.
std::filesystem::path default_cache() {
  const auto absolute = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    const std::filesystem::path path = value == nullptr ? "" : value;
    return path.is_absolute() ? path : std::filesystem::path();
  };
  if (const auto cache = absolute("XDG_CACHE_HOME"); !cache.empty()) return cache / "mottle";
  if (const auto home = absolute("HOME"); !home.empty()) return home / ".cache" / "mottle";
  return {};
}

/// The verdict's word in its colour, where standard output is a terminal that shows colours.
std::string coloured(const std::string& line) {
  static const bool is_wanted = ::isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  constexpr std::string_view k_verdict = "verdict: ";
  if (!is_wanted) return line;
  if (line.starts_with("warning: ")) return fmt::format("\033[33m{}\033[0m", line);
  if (!line.starts_with(k_verdict)) return line;
  const std::string word = line.substr(k_verdict.size());
  const int colour = word.starts_with("adequate") ? 32 : word.starts_with("inadequate") ? 31 : 33;
  return fmt::format("{}\033[1;{}m{}\033[0m", k_verdict, colour, word);
}

}  // namespace

std::filesystem::path cache_folder(const std::string& given) {
  if (given.empty()) return default_cache();
  return given == "off" ? std::filesystem::path() : std::filesystem::path(given);
}

void add_common_options(CLI::App& verb, CommonOptions& options) {
  verb.add_option("STUDY", options.study, "the study file (TOML)")->required();
  verb.add_option("--out", options.out, "folder for the results (default: STUDY.mottle beside the study)");
  verb.add_option("--set", options.assignments, "override one value: dotted.key=value, in TOML; may be repeated")
      ->allow_extra_args(false);
  verb.add_option("--threads", options.threads, "threads to compute with (default: all processors)")
      ->check(CLI::Range(1, 4096));
  verb.add_option("--seed", options.seed, "seed of the random streams (default: the study's, or 1)")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9223372036854775807U}));
  verb.add_flag("--resume", options.resume, "go on with an interrupted run in the same folder");
  verb.add_option("--cache", options.cache,
                  "folder of trained reduced models that later runs read (default: $XDG_CACHE_HOME/mottle or "
                  "~/.cache/mottle), or off");
  verb.add_flag("--no-run", options.runs_nothing, "start no program: refuse a study whose model is run by one");
  verb.add_flag("--quiet", options.quiet, "say nothing but errors");
  verb.add_flag("--json", options.json, "print a summary as one line of JSON");
}

Study read_study(const CommonOptions& options) {
  return study::read_study(options.study, {.assignments = options.assignments, .seed = options.seed});
}

RunSettings run_settings(const CommonOptions& options, Console& console, Ranks* ranks) {
  std::filesystem::path folder = options.out;
  if (options.out.empty()) {
    folder = options.study;
    folder.replace_extension(".mottle");
  }
  const int available = ranks == nullptr ? available_threads() : threads_of_rank(*ranks);
  return {.folder = is_helper(ranks) ? std::filesystem::path() : folder,
          .cache = cache_folder(options.cache),
          .threads = options.threads > 0 ? options.threads : available,
          .resume = options.resume,
          .may_run_programs = !options.runs_nothing,
          .observer = &console,
          .stop = &stop_flag(),
          .ranks = ranks,
          .run_folder = is_helper(ranks) ? folder : std::filesystem::path()};
}

void print_summary(const CommonOptions& options, const RunSummary& summary) {
  if (options.json) {
    fmt::print("{}\n", summary.json);
  } else if (!options.quiet) {
    // A stranger's texts (titles, programs, names of files) may not speak to the terminal.
    for (const std::string& line : summary.lines) fmt::print("{}\n", coloured(printable(line)));
  }
}

}  // namespace mottle::app
