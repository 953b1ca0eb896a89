#include "mottle/study/jobs/update.hpp"

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/jobs/expected_runs.hpp"
#include "study/jobs/find_could_hide.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/jobs/update_by_plan.hpp"
#include "study/jobs/update_workings.hpp"
#include "study/results/solver_use.hpp"
#include "study/results/update_text.hpp"
#include "study/tests/rank_numbering.hpp"

namespace mottle::study {
namespace {

void note_what_happened(const UpdatingResult& result, std::int64_t reused, const RunContext& context) {
  std::size_t failed = 0;
  for (const IterationRecord& state : result.history) failed += state.failures.size();
  std::size_t noted = 0;
  for (const SampleNote& note : result.history.back().notes) noted += note.text.empty() ? 0 : 1;
  if (noted > 0) {
    context.note(fmt::format(
        "in {} samples of the last cloud modes crossed or mixed; the status column of cloud-final.csv says which",
        noted));
  }
  if (failed > 0) {
    context.warning(
        fmt::format("{} of {} model runs failed and were left out; if failures are not a matter of chance, "
                    "the clouds are biased",
                    failed, result.model_evaluations));
  }
  for (const std::string& warning : result.warnings) context.warning(warning);
  if (reused > 0) context.note(fmt::format("{} model runs of the interrupted run were used again", reused));
  context.note(fmt::format("{}: {}", status_text(result.status), result.message));
}

void note_what_is_given(const Study& study, const UpdatePlan& plan, const RunContext& context) {
  for (const std::string& note : plan.made.notes) context.note(note);
  for (const std::string& note : plan.tests.notes) context.note(note);
  for (const TestDoubt& doubt : plan.tests.doubts) context.warning(doubt.sentence);
  if (!plan.covariance_groups.empty() && !find_method(study.update.method).estimates_population) {
    context.warning(fmt::format("update.covariance is not used: method '{}' does not estimate the scatter of specimens",
                                study.update.method));
  }
}

std::optional<std::string> doubt_of_numbering(const UpdatePlan& plan, const UpdatingResult& result) {
  if (plan.given) return std::nullopt;
  const OutputSelection& outputs = plan.made.model->selection();
  std::optional<std::string> doubt;
  if (plan.tests.is_by_rank) doubt = rank_warning(outputs, plan.tests.data.values, result.history);
  if (!doubt && !result.history.empty()) doubt = bend_warning(outputs, result.history.back());
  return doubt;
}

/// Verdict, errors that could hide behind it, and the prediction.
void assess(UpdateOutcome& outcome, const RunContext& context) {
  const UpdatePlan& plan = outcome.workings->plan;
  const UpdatingProblem& problem = outcome.problem();
  UpdatingResult& result = outcome.result;
  context.phase({.name = "errors that could stay hidden"});
  outcome.could_hide =
      find_could_hide(outcome.study, plan.made, problem, result, judge(problem, result).conclusion, context);
  const CouldHide& hidden = outcome.could_hide;
  result.not_tested.insert(result.not_tested.end(), hidden.sentences.begin(), hidden.sentences.end());
  result.notes.insert(result.notes.end(), hidden.notes.begin(), hidden.notes.end());
  outcome.verdict = judge(problem, result);
  outcome.numbering = doubt_of_numbering(plan, result);
  if (outcome.numbering) context.warning(*outcome.numbering);
  if (plan.prediction) {
    context.phase({.name = "prediction"});
    outcome.prediction = run_prediction(outcome.study, *plan.prediction, problem, result, context);
  }
}

}  // namespace

UpdateOutcome update_by_plan(const Study& study, UpdatePlan given_plan, double start, const RunSettings& settings) {
  const auto workings = std::make_shared<UpdateWorkings>(UpdateWorkings{.plan = std::move(given_plan)});
  const UpdatePlan& plan = workings->plan;
  workings->factors = factor_nominals(study);
  workings->model_files = digest_model_files(study, plan.made.files);
  workings->study_files = digest_study_files(study);
  UpdateOutcome outcome{.study = study, .workings = workings, .ranks = rank_count(settings)};
  if (!plan.tests.doubts.empty()) {  // a study that is refused is told that alone, and leaves no files
    refuse_what_methods_refuse(study, plan, {.seed = study.seed, .threads = settings.threads, .stop = settings.stop});
  }
  const JobFiles files(settings, k_log, k_journal);
  const RunContext context = files.context(study, settings);
  auto model = std::make_unique<JournalledModel>(plan.model(), files.journal(), fingerprint_of(study, plan),
                                                 settings.resume, settings.ranks);
  const JournalledModel& journalled = *model;
  workings->model = std::move(model);
  UpdatingProblem problem = problem_of(study, plan, *workings->model);
  if (plan.given && problem.derivatives != nullptr) {
    workings->derivatives = std::make_unique<JournalledDerivatives>(journalled, *problem.derivatives);
    problem.derivatives = workings->derivatives.get();
  }
  workings->given = std::make_unique<UpdatingProblem>(std::move(problem));
  if (study.surrogate) workings->surrogate = std::make_unique<SurrogateUpdate>(*workings->given, *study.surrogate);
  note_ranks(settings, context);
  note_what_is_given(study, plan, context);
  note_expected_runs(study, plan, context);
  const double ready = steady_seconds();
  outcome.result = files.compute(study, [&] {
    return workings->surrogate ? workings->surrogate->run(*plan.method, context)
                               : plan.method->update(*workings->given, context);
  });
  if (outcome.result.status == UpdatingStatus::stopped) throw Stopped(outcome.result.message);
  const double updated = steady_seconds();
  note_what_happened(outcome.result, journalled.reused(), context);
  assess(outcome, context);
  if (const std::string word = plan.made.program ? plan.made.program->last_word() : ""; !word.empty()) {
    context.note(word);
    outcome.result.notes.push_back(word);
  }
  outcome.solver_use = journalled.use();
  log_solver_use(outcome.solver_use, context);
  for (const std::string& line : verdict_lines(outcome)) context.note(line);
  outcome.reading_seconds = ready - start;
  outcome.updating_seconds = updated - ready;
  outcome.assessing_seconds = steady_seconds() - updated;
  return outcome;
}

const UpdatingProblem& UpdateOutcome::problem() const {
  return workings->problem();
}

UpdateOutcome update(const Study& study, const RunSettings& settings) {
  require_ranks(study, settings);
  require_place_of_update(study, settings.folder);
  return without_earlier(settings.folder, results_not_read(settings.folder, result_names(), paths_of(study)), [&] {
    const double start = steady_seconds();
    return update_by_plan(study, plan_update(study, settings), start, settings);
  });
}

}  // namespace mottle::study
