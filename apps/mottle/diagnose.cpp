// mottle diagnose
#include "mottle/study/jobs/diagnose.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/core/error.hpp"
#include "mottle/report/report.hpp"
#include "mottle/study/results/folder_lock.hpp"

namespace mottle::app {
namespace {

/// Results and page, of the linear answer or of the fits.
void write_down(const DiagnoseOutcome& outcome, const std::filesystem::path& folder) {
  write_results(outcome, folder);
  write_diagnosis_page(folder);
}

/// The report of an update in the same folder links the page from now on. It is not this job's: one that cannot be
/// drawn again stays as it is.
void link_from_report(const std::filesystem::path& folder, Console& console) {
  if (!std::filesystem::exists(folder / "report.html") || !std::filesystem::exists(folder / "result.json")) return;
  try {
    write_report(folder);
  } catch (const InvalidInput& error) {
    console.note(fmt::format("The report beside the diagnosis could not be drawn again: {}", error.what()));
  }
}

}  // namespace

void add_diagnose(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("diagnose", "say which parameter is missing, and which can be identified");
  const auto options = std::make_shared<CommonOptions>();
  const auto is_thorough = std::make_shared<bool>(false);
  add_common_options(*verb, *options);
  verb->add_flag("--thorough", *is_thorough, "fit all candidates in the model itself, not the best ones alone");
  verb->callback([options, is_thorough] {
    Ranks* const ranks = join_job("diagnose");
    const Study study = read_study(*options);
    Console console(options->quiet || is_helper(ranks));
    console.begin("reading the model and the tests");
    const RunSettings settings = run_settings(*options, console, ranks);
    if (is_helper(ranks)) return (void)diagnose(study, settings, {.is_thorough = *is_thorough});
    const FolderLock lock(settings.folder);
    const DiagnoseOutcome outcome =
        diagnose(study, settings, {.is_thorough = *is_thorough, .linear_answer = [&settings](const auto& linear) {
                                     write_down(linear, settings.folder);
                                   }});
    go_alone(ranks);
    write_down(outcome, settings.folder);
    link_from_report(settings.folder, console);
    console.finish();
    print_summary(*options, summarise(outcome, settings.folder));
    if (!options->json && !options->quiet) fmt::print("page: {}\n", (settings.folder / "diagnosis.html").string());
  });
}

}  // namespace mottle::app
