#include "mottle/study/jobs/diagnose.hpp"

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/jobs/candidate_evidence.hpp"
#include "study/jobs/candidate_models.hpp"
#include "study/jobs/candidates.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/model_around.hpp"
#include "study/jobs/study_reach.hpp"
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

/// By smaller models where one of all candidates is large and there are several; null: the whole one serves.
std::unique_ptr<CandidateModels> smaller_models(const Study& study, const std::vector<StudyParameter>& candidates,
                                                const StudyModel& made, RunSettings settings) {
  constexpr Eigen::Index k_large = 500;  // equations, from which on clouds are solved by a reduced model
  const Structure& structure = made.model->structure();
  if (candidates.size() < 2 || structure.mode_count() < k_large || made.model->derivatives() == nullptr) return nullptr;
  settings.cache.clear();  // one of each candidate would fill it
  auto make = [&study, &candidates, settings](const std::vector<Eigen::Index>& moved, const Eigen::VectorXd& centre) {
    std::vector<StudyParameter> chosen;
    for (const Eigen::Index candidate : moved) chosen.push_back(candidates[static_cast<std::size_t>(candidate)]);
    const Study smaller = with_candidates(study, chosen);
    return make_model_around(centre, smaller, smaller.parameters, settings);
  };
  return std::make_unique<CandidateModels>(*made.model, static_cast<Eigen::Index>(study.parameters.list.size()),
                                           *made.space, std::move(make));
}

DiagnoseOutcome diagnose_here(const Study& study, const RunSettings& settings) {
  const double start = steady_seconds();
  require(!study.parameters.list.empty(), "{}: parameter: there is none; give at least one [[parameter]]",
          study.file.string());
  const std::vector<StudyParameter> candidates = resolve_candidates(study);
  DiagnoseOutcome outcome{.study = study, .whole = with_candidates(study, candidates)};
  const std::vector<StudyParameter> about_model = about_model_values(study, candidates);
  const Study examined = with_candidates(study, about_model);
  const StudyModel made = make_model(examined, examined.parameters, settings);
  const StudyTests tests = read_tests(study, *made.model);
  refuse_unit_errors(study, made, tests);
  const JobFiles files(settings, k_diagnosis_log, k_diagnosis_journal);
  const RunContext context = files.context(study, settings);
  const std::unique_ptr<CandidateModels> smaller = smaller_models(study, about_model, made, settings);
  const JournalledModel model(smaller ? static_cast<const Model&>(*smaller) : *made.model, files.journal(),
                              study_fingerprint(examined, made), settings.resume, settings.ranks);
  std::vector<std::string> given;
  for (const StudyParameter& parameter : study.parameters.list) given.push_back(parameter.name);
  const UpdatingProblem problem{.model = model,
                                .derivatives = smaller ? smaller.get() : made.model->derivatives(),
                                .space = *made.space,
                                .tests = tests.data,
                                .iterations = study.update.iterations,
                                .level = study.update.level,
                                .tolerance = study.update.tolerance,
                                .covariance_groups = covariance_groups(study, given)};
  outcome.ranks = rank_count(settings);
  note_ranks(settings, context);
  note_what_is_given(made, tests, context);
  const DiagnosisSettings rules{.given = static_cast<Eigen::Index>(study.parameters.list.size()),
                                .screened = study.diagnose.screened,
                                .like_evidence = study.diagnose.like_evidence};
  outcome.diagnosis = files.compute(study, [&] { return diagnose(problem, rules, context); });
  outcome.evidence = evidence_of_candidates(study, candidates, outcome.diagnosis, settings, context);
  outcome.outputs = tests.data.values.cols();
  outcome.seconds = steady_seconds() - start;
  return outcome;
}

}  // namespace

DiagnoseOutcome diagnose(const Study& study, const RunSettings& settings) {
  require_own(settings.folder, {k_diagnosis, k_diagnosis_log, k_diagnosis_journal}, paths_of(study));
  require_ranks(study, settings);
  return without_earlier(settings.folder, {k_diagnosis}, [&] { return diagnose_here(study, settings); });
}

}  // namespace mottle::study
