// mottle init: a first study of a deck and its tests.
#include "mottle/study/jobs/init.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "common_options.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/shell_word.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::app {
namespace {

struct InitOptions {
  InitSettings settings;
  std::string units;
  std::vector<int> modes;
  std::vector<std::string> targets, cards;
  std::string cache;
  bool accepts = false;
  bool is_json = false;
};

/// One line of the answer; the end of the input is an empty one.
std::string ask(const std::string& question) {
  fmt::print("{}", question);
  std::fflush(stdout);
  std::string answer;
  std::getline(std::cin, answer);
  return answer;
}

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> found(1);
  for (const char c : text) {
    if (c == ' ' || c == ',') {
      if (!found.back().empty()) found.emplace_back();
    } else {
      found.back() += c;
    }
  }
  if (found.back().empty()) found.pop_back();
  return found;
}

std::vector<int> whole_numbers(const std::string& text) {
  std::vector<int> numbers;
  for (const std::string& word : words(text)) {
    double number = 0.0;
    if (!parse_number(word, number) || number != static_cast<int>(number)) {
      throw InvalidInput(fmt::format("'{}' is not the number of a mode; an answer is a list like 3 4 7", word));
    }
    numbers.push_back(static_cast<int>(number));
  }
  return numbers;
}

void print(const InitOutcome& outcome) {
  for (const std::string& line : summarise(outcome).lines) fmt::print("{}\n", printable(line));
}

/// With a sign of life, which is gone before anything is asked or printed.
InitOutcome propose(const InitSettings& settings) {
  Console console(false);
  console.begin("reading and solving the deck");
  return propose_study(settings);
}

/// Empty: those that are proposed. Another answer is asked for again.
std::string ask_units(const std::string& proposed) {
  while (true) {
    std::string answer = ask(fmt::format("Units of the deck: {} [{}]: ", join(unit_systems()), proposed));
    if (answer.empty() || std::ranges::count(unit_systems(), answer) > 0) return answer;
    tell(fmt::format("mottle: '{}' is none of these systems\n", printable(answer)));
  }
}

/// Lets the user change units, outputs and parameters until an empty answer accepts what is proposed.
InitOutcome converse(InitSettings settings) {
  InitOutcome outcome = propose(settings);
  if (outcome.kind == "command") {  // what is unknown is more than a few answers
    print(outcome);
    return outcome;
  }
  const std::string units = ask_units(*outcome.settings.units);
  settings.units = units.empty() ? *outcome.settings.units : units;
  if (!units.empty()) outcome = propose(settings);
  print(outcome);
  while (true) {
    const std::string modes = ask("Modes that are outputs, as 3 4 7 [those marked yes]: ");
    const std::string targets = ask("Targets of the parameters, as MAT1:2:E PELAS:4:K [those with a name]: ");
    if (modes.empty() && targets.empty()) return outcome;
    InitSettings asked = settings;
    try {
      if (!modes.empty()) asked.modes = whole_numbers(modes);
      if (!targets.empty()) asked.targets = words(targets);
      outcome = propose(asked);
      settings = asked;  // what cannot be is asked for again
      print(outcome);
    } catch (const InvalidInput& error) {
      tell(fmt::format("mottle: {}\n", printable(error.what())));
    }
  }
}

void init(InitOptions options) {
  InitSettings& settings = options.settings;
  if (settings.study.empty()) settings.study = std::filesystem::path(settings.model).replace_extension(".toml");
  require(!std::filesystem::exists(settings.study),
          "{}: is there already, and is not written over; name another file with --out", settings.study.string());
  const std::filesystem::path folder = std::filesystem::absolute(settings.study).parent_path();
  require(std::filesystem::is_directory(folder),
          "{}: there is no such folder for the study; make it, or name another file "
          "with --out",
          folder.string());
  for (const std::string& card : options.cards) settings.ignore_cards.insert(capitals(card));
  settings.cache = cache_folder(options.cache);
  if (!options.units.empty()) settings.units = options.units;
  if (!options.modes.empty()) settings.modes = options.modes;
  if (!options.targets.empty()) settings.targets = options.targets;
  const bool asks = !options.accepts && !options.is_json && ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
  const InitOutcome outcome = asks ? converse(settings) : propose(settings);
  write_file_atomically(settings.study, outcome.text);
  if (options.is_json) {
    fmt::print("{}\n", summarise(outcome).json);
    return;
  }
  if (!asks) print(outcome);
  const std::string study = shell_word(settings.study.string());
  fmt::print("study: {}\nnext: {}mottle check {}; mottle {} {}\n", settings.study.string(),
             outcome.kind == "command" ? "fill in what is UNKNOWN; " : "", study,
             settings.tests.empty() ? "propagate" : "update", study);
}

}  // namespace

void add_init(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("init", "propose a first study of a model and its tests, with reasons");
  const auto options = std::make_shared<InitOptions>();
  verb->add_option("model", options->settings.model,
                   "deck of Nastran, or of CalculiX (*.inp), or a solver's input with placeholders {{name}}")
      ->required();
  verb->add_option("tests", options->settings.tests, "test files (.uff, .unv, .csv, .mat), folders or patterns");
  verb->add_option("--out", options->settings.study, "study to write (default: MODEL.toml beside the deck)");
  verb->add_option("--units", options->units, "units of the deck (default: guessed from its materials)")
      ->check(CLI::IsMember(unit_systems()));
  verb->add_option("--outputs", options->modes, "modes that are outputs, in the model's numbers (3,4,7)")
      ->delimiter(',');
  verb->add_option("--targets", options->targets, "targets of the parameters (MAT1:2:E,PELAS:4:K)")->delimiter(',');
  verb->add_option("--ignore-cards", options->cards, "leave out these cards (CARD,CARD)")->delimiter(',');
  verb->add_option("--cache", options->cache,
                   "folder of CalculiX's matrices that later runs read (default: $XDG_CACHE_HOME/mottle or "
                   "~/.cache/mottle), or off");
  verb->add_flag("--yes", options->accepts, "ask nothing, also on a terminal");
  verb->add_flag("--json", options->is_json, "machine-readable summary on stdout; asks nothing");
  verb->callback([options] { init(*options); });
}

}  // namespace mottle::app
