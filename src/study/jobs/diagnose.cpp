#include "mottle/study/jobs/diagnose.hpp"

#include "mottle/core/error.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/jobs/candidates.hpp"
#include "study/jobs/job_files.hpp"
#include "study/results/diagnosis_names.hpp"
#include "study/tests/rank_numbering.hpp"
#include "study/tests/unit_errors.hpp"

namespace mottle::study {
namespace {

void note_what_is_given(const StudyModel& made, const StudyTests& tests, const RunContext& context) {
  for (const std::string& note : made.notes) context.note(note);
  for (const std::string& note : tests.notes) context.note(note);
  if (!tests.is_by_rank) return;
  if (const auto numbering = rank_note(made.model->selection(), tests.data.values)) context.note(*numbering);
}

DiagnoseOutcome diagnose_here(const Study& study, const RunSettings& settings) {
  const double start = steady_seconds();
  require(!study.parameters.list.empty(), "{}: parameter: there is none; give at least one [[parameter]]",
          study.file.string());
  DiagnoseOutcome outcome{.study = study, .whole = with_candidates(study, resolve_candidates(study))};
  const StudyModel made = make_model(outcome.whole, outcome.whole.parameters, settings);
  const StudyTests tests = read_tests(study, *made.model);
  refuse_unit_errors(study, made, tests);
  const JobFiles files(settings, k_diagnosis_log, k_diagnosis_journal);
  const RunContext context = files.context(study, settings);
  const JournalledModel model(*made.model, files.journal(), study_fingerprint(outcome.whole, made), settings.resume);
  std::vector<std::string> given;
  for (const StudyParameter& parameter : study.parameters.list) given.push_back(parameter.name);
  const UpdatingProblem problem{.model = model,
                                .derivatives = made.model->derivatives(),
                                .space = *made.space,
                                .tests = tests.data,
                                .iterations = study.update.iterations,
                                .level = study.update.level,
                                .tolerance = study.update.tolerance,
                                .covariance_groups = covariance_groups(study, given)};
  note_what_is_given(made, tests, context);
  const DiagnosisSettings rules{.given = static_cast<Eigen::Index>(study.parameters.list.size()),
                                .screened = study.diagnose.screened,
                                .like_evidence = study.diagnose.like_evidence};
  outcome.diagnosis = files.compute(study, [&] { return diagnose(problem, rules, context); });
  outcome.seconds = steady_seconds() - start;
  return outcome;
}

}  // namespace

DiagnoseOutcome diagnose(const Study& study, const RunSettings& settings) {
  return without_earlier(settings.folder, {k_diagnosis}, [&] { return diagnose_here(study, settings); });
}

}  // namespace mottle::study
