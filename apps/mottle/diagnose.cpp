// mottle diagnose
#include "mottle/study/jobs/diagnose.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/study/results/folder_lock.hpp"

namespace mottle::app {

void add_diagnose(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("diagnose", "say which parameter is missing, and which can be identified");
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(*verb, *options);
  verb->callback([options] {
    Ranks* const ranks = join_job("diagnose");
    const Study study = read_study(*options);
    Console console(options->quiet || is_helper(ranks));
    console.begin("reading the model and the tests");
    const RunSettings settings = run_settings(*options, console, ranks);
    if (is_helper(ranks)) return (void)diagnose(study, settings);
    const FolderLock lock(settings.folder);
    const DiagnoseOutcome outcome = diagnose(study, settings);
    go_alone(ranks);
    write_results(outcome, settings.folder);
    console.finish();
    print_summary(*options, summarise(outcome, settings.folder));
  });
}

}  // namespace mottle::app
