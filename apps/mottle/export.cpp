// mottle export: the result of an update as decks, tables and a study that goes on from it.
#include "mottle/study/jobs/export.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::app {

void add_export(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("export", "decks with the updated values, tables, and a study that goes on from them");
  const auto settings = std::make_shared<ExportSettings>();
  const auto is_json = std::make_shared<bool>(false);
  const auto is_quiet = std::make_shared<bool>(false);
  verb->add_option("DIR", settings->results, "folder of an update's results")->required();
  verb->add_option("--out", settings->out, "folder to make (default: DIR/export)");
  verb->add_option("--decks", settings->decks, "decks of so many samples besides that of the means")
      ->check(CLI::Range(0, 9999));
  verb->add_flag("--changed-model", settings->accepts_changes,
                 "export although files of the model have changed since the update");
  verb->add_flag("--json", *is_json, "machine-readable summary on stdout");
  verb->add_flag("--quiet", *is_quiet, "print nothing");
  verb->callback([=] {
    const ExportOutcome outcome = make_export(*settings);
    write_results(outcome);
    const RunSummary summary = summarise(outcome);
    if (*is_json) {
      fmt::print("{}\n", summary.json);
    } else if (!*is_quiet) {
      for (const std::string& line : summary.lines) fmt::print("{}\n", printable(line));
    }
  });
}

}  // namespace mottle::app
