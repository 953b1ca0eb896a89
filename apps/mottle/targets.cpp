// mottle targets: the numbers of a deck that can be parameters, and what each does to the modes.
#include "mottle/study/jobs/targets.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::app {

void add_targets(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("targets", "numbers of a deck that can be parameters; what each changes");
  const auto settings = std::make_shared<TargetsSettings>();
  const auto cards = std::make_shared<std::vector<std::string>>();
  const auto is_json = std::make_shared<bool>(false);
  const auto is_csv = std::make_shared<bool>(false);
  verb->add_option("model", settings->model, "deck of Nastran, or of CalculiX (.inp)")->required();
  verb->add_option("--modes", settings->modes, "number of lowest modes (default: the deck's EIGRL, or 10)")
      ->check(CLI::Range(1, 100000));
  verb->add_option("--units", settings->units,
                   "units of the deck, which are only named (SI, mm-t-s, mm-kg-ms, in-lbf-s; default: guessed)")
      ->check(CLI::IsMember(unit_systems()));
  verb->add_option("--subcase", settings->subcase, "subcase of the deck (default: the first with a METHOD)");
  verb->add_option("--ignore-cards", *cards, "leave out these cards (CARD,CARD)")->delimiter(',');
  verb->add_flag("--all", settings->lists_all, "list every number, also those that change no mode or are seldom wrong");
  CLI::Option* json = verb->add_flag("--json", *is_json, "every mode, as one line of JSON on stdout");
  verb->add_flag("--csv", *is_csv, "every mode, as a table on stdout")->excludes(json);
  verb->callback([=] {
    settings->cache = cache_folder("");
    for (const std::string& card : *cards) settings->ignore_cards.insert(capitals(card));
    Console console(false);
    console.begin("reading and solving the deck");
    const TargetsOutcome outcome = find_targets(*settings);
    console.finish();
    const RunSummary summary = summarise(outcome);
    if (*is_json) {
      fmt::print("{}\n", summary.json);
    } else if (*is_csv) {
      fmt::print("{}", targets_csv(outcome));
    } else {
      for (const std::string& line : summary.lines) fmt::print("{}\n", printable(line));
    }
  });
}

}  // namespace mottle::app
