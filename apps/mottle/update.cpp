// mottle update
#include "mottle/study/jobs/update.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/report/report.hpp"
#include "mottle/study/results/folder_lock.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::app {
namespace {

/// The outcome holds clouds and the model: it goes before the report is made.
RunSummary update_into_folder(const Study& study, const RunSettings& settings, Console& console) {
  const UpdateOutcome outcome = update(study, settings);
  go_alone(settings.ranks);
  console.begin("writing the results");
  write_results(outcome, settings.folder);
  return summarise(outcome, settings.folder);
}

}  // namespace

void add_update(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("update", "find the distribution of the parameters that explains the tests");
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(*verb, *options);
  verb->callback([options] {
    Ranks* const ranks = join_job("update");
    const Study study = read_study(*options);
    Console console(options->quiet || is_helper(ranks));
    console.begin("reading the model and the tests");
    const RunSettings settings = run_settings(*options, console, ranks);
    if (is_helper(ranks)) return (void)update(study, settings);
    const FolderLock lock(settings.folder);
    const RunSummary summary = update_into_folder(study, settings, console);
    console.begin("writing the report");
    write_report(settings.folder);
    RunFolder(settings.folder).finish();
    console.finish();
    print_summary(*options, summary);
    if (!options->json && !options->quiet) fmt::print("report: {}\n", (settings.folder / "report.html").string());
  });
}

}  // namespace mottle::app
