// mottle propagate, mottle simulate, mottle check: the verbs that only run the model forward.
#include "mottle/study/jobs/forward.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "common_options.hpp"
#include "job_ranks.hpp"
#include "mottle/report/report.hpp"
#include "mottle/study/jobs/check.hpp"
#include "mottle/study/jobs/serve.hpp"
#include "mottle/study/results/folder_lock.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::app {
namespace {

constexpr const char* k_offer_ends = "mottle: stopped on request; the model is no longer offered\n";

/// The outcome holds the cloud and the model: it goes before the report is made.
RunSummary propagate_into_folder(const Study& study, const std::optional<std::filesystem::path>& points,
                                 const RunSettings& settings, Console& console) {
  const PropagateOutcome outcome = propagate(study, points, settings);
  go_alone(settings.ranks);
  console.begin("writing the results and the report");
  write_results(outcome, settings.folder);
  return summarise(outcome, settings.folder);
}

/// A program that starts this one reads the address as soon as it is there. Of several ranks the first one alone offers
/// the model.
void offer_model(const CommonOptions& options, int port) {
  if (is_silent_rank()) return;
  say_when_stopped(k_offer_ends);
  const Study study = read_study(options);
  Console console(options.quiet);
  console.begin("reading the model");
  serve(study, port, run_settings(options, console), [&](const OfferedModel& offered) {
    console.finish();
    print_summary(options, summarise(offered));
    (void)std::fflush(stdout);
  });
  tell(k_offer_ends);
  throw CLI::RuntimeError(k_stopped);
}

}  // namespace

void add_propagate(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("propagate",
                                      "propagate samples through the model without updating, or "
                                      "evaluate given points");
  const auto options = std::make_shared<CommonOptions>();
  const auto points = std::make_shared<std::optional<std::filesystem::path>>();
  const auto port = std::make_shared<std::optional<int>>();
  add_common_options(*verb, *options);
  CLI::Option* given =
      verb->add_option("--points", *points, "CSV of parameter vectors to evaluate (header = parameter names)");
  verb->add_option("--umbridge", *port,
                   "instead offer the model to UM-Bridge clients of this machine at http://127.0.0.1:PORT until "
                   "stopped (0: a free port)")
      ->check(CLI::Range(0, 65535))
      ->excludes(given)
      ->excludes(verb->get_option("--out"))
      ->excludes(verb->get_option("--resume"));
  verb->callback([options, points, port] {
    if (*port) return offer_model(*options, **port);
    Ranks* const ranks = join_job("propagate");
    const Study study = read_study(*options);
    Console console(options->quiet || is_helper(ranks));
    console.begin("reading the model and the tests");
    const RunSettings settings = run_settings(*options, console, ranks);
    if (is_helper(ranks)) return (void)propagate(study, *points, settings);
    const FolderLock lock(settings.folder);
    const RunSummary summary = propagate_into_folder(study, *points, settings, console);
    write_report(settings.folder);
    RunFolder(settings.folder).finish();
    console.finish();
    print_summary(*options, summary);
    if (!options->json && !options->quiet) fmt::print("cloud: {}\n", (settings.folder / "cloud.csv").string());
  });
}

void add_simulate(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("simulate", "draw specimens from the study's [truth] into a CSV");
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(*verb, *options);
  verb->callback([options] {
    const Study study = read_study(*options);
    Console console(options->quiet);
    console.begin("reading the model");
    const RunSettings settings = run_settings(*options, console);
    const FolderLock lock(settings.folder);
    const SimulateOutcome outcome = simulate(study, settings);
    write_results(outcome, settings.folder);
    console.finish();
    print_summary(*options, summarise(outcome, settings.folder));
  });
}

void add_check(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("check", "read everything and say what would run");
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(*verb, *options);
  verb->callback([options] {
    Console console(options->quiet);
    console.begin("reading the model and the tests");
    const RunSummary summary = summarise(check(read_study(*options), run_settings(*options, console)));
    console.finish();
    print_summary(*options, summary);
  });
}

}  // namespace mottle::app
