// mottle modes: natural frequencies and shapes of a model, a page that shows them, MAC against others.
#include "mottle/study/jobs/modes.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/report/report.hpp"
#include "mottle/study/results/folder_lock.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::app {

void add_modes(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("modes", "natural frequencies and shapes of a Nastran deck; MAC against others");
  const auto settings = std::make_shared<ModesSettings>();
  const auto folder = std::make_shared<std::filesystem::path>();
  const auto cards = std::make_shared<std::vector<std::string>>();
  const auto is_json = std::make_shared<bool>(false);
  const auto is_quiet = std::make_shared<bool>(false);
  verb->add_option("model", settings->model, "Nastran deck")->required();
  verb->add_option("--out", *folder, "folder of the results (default: MODEL.modes beside the deck)");
  verb->add_option("--modes", settings->modes, "number of lowest modes (default: the deck's EIGRL, or 10)")
      ->check(CLI::Range(1, 100000));
  verb->add_option("--compare", settings->compare, "CSV of shapes (dof, one column for each mode) or another deck");
  verb->add_option("--subcase", settings->subcase, "subcase of the deck (default: the first with a METHOD)");
  verb->add_option("--ignore-cards", *cards, "leave out these cards (CARD,CARD)")->delimiter(',');
  verb->add_flag("--uff", settings->writes_universal_file, "also write modes.uff: grid points and shapes, global axes");
  verb->add_flag("--json", *is_json, "machine-readable summary on stdout");
  verb->add_flag("--quiet", *is_quiet, "print nothing");
  verb->callback([=] {
    for (const std::string& card : *cards) settings->ignore_cards.insert(capitals(card));
    if (folder->empty()) *folder = std::filesystem::path(settings->model).replace_extension(".modes");
    const FolderLock lock(*folder);
    Console console(*is_quiet);
    console.begin("reading and solving the deck");
    const ModesOutcome outcome = find_modes(*settings, *folder);
    write_results(outcome, *folder);
    write_modes_page(*folder);
    RunFolder(*folder).forget_previous(modes_names());
    const RunSummary summary = summarise(outcome, *folder);
    console.finish();
    if (*is_json) {
      fmt::print("{}\n", summary.json);
    } else if (!*is_quiet) {
      for (const std::string& line : summary.lines) fmt::print("{}\n", printable(line));
      fmt::print("page: {}\n", (*folder / "modes.html").string());
    }
  });
}

}  // namespace mottle::app
