#include "mottle/study/jobs/diagnose.hpp"

#include <algorithm>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/jobs/candidate_evidence.hpp"
#include "study/jobs/candidate_models.hpp"
#include "study/jobs/candidates.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/model_around.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/results/diagnosis_names.hpp"
#include "study/results/modes_json.hpp"
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

constexpr Eigen::Index k_large = 500;  // equations, from which on clouds are solved by a reduced model

/// By smaller models where one of all candidates is large and there are several; null: the whole one serves.
std::unique_ptr<CandidateModels> smaller_models(const Study& study, const std::vector<StudyParameter>& candidates,
                                                const StudyModel& made, RunSettings settings) {
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

/// The best four of a large model, which takes seconds for each.
DiagnosisSettings rules_of(const Study& study, const StudyModel& made, const DiagnoseChoices& choices) {
  constexpr int k_fitted_of_large = 4;
  const bool is_large = made.model->structure().mode_count() >= k_large;
  const bool is_brief = is_large && !choices.is_thorough;
  return {.given = static_cast<Eigen::Index>(study.parameters.list.size()),
          .screened = is_brief ? std::min(study.diagnose.screened, k_fitted_of_large) : study.diagnose.screened,
          .fits_all = choices.is_thorough,
          .like_evidence = study.diagnose.like_evidence};
}

/// Empty where the model is none of finite elements whose parameters are on its cards.
std::string drawing_of(const StudyModel& made) {
  const Structure& structure = made.model->structure();
  if (structure.mesh() == nullptr) return {};
  Json parts = parameter_parts_json(structure, made.space->names());
  if (parts.empty()) return {};
  Json drawing = drawing_json(structure, {});
  drawing["parameters"] = std::move(parts);
  return one_line(drawing);
}

/// What of the model stands in the results.
void describe_model(const StudyModel& made, const RunSettings& settings, DiagnoseOutcome& outcome) {
  outcome.outputs = static_cast<Eigen::Index>(made.model->outputs().size());
  for (const Quantity& output : made.model->outputs()) outcome.output_names.push_back(output.name());
  outcome.drawing = drawing_of(made);
  outcome.ranks = rank_count(settings);
}

/// What an interrupted run left as its linear answer is no result that is worth keeping.
std::vector<std::string> earlier_results(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / k_diagnosis;
  std::error_code ignored;
  if (folder.empty() || !std::filesystem::is_regular_file(file, ignored)) return diagnosis_names();
  const Json json = Json::parse(read_file(file), nullptr, false);
  const bool is_linear = json.is_object() && json.contains("stage") && json["stage"] == k_linear_stage;
  return is_linear ? std::vector<std::string>{} : diagnosis_names();
}

DiagnoseOutcome diagnose_here(const Study& study, const RunSettings& settings, const DiagnoseChoices& choices) {
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
  describe_model(made, settings, outcome);
  note_ranks(settings, context);
  note_what_is_given(made, tests, context);
  const DiagnosisSettings rules = rules_of(study, made, choices);
  const auto tell = [&](const Diagnosis& linear) {
    if (!choices.linear_answer) return;
    outcome.diagnosis = linear;
    outcome.seconds = steady_seconds() - start;
    choices.linear_answer(outcome);
  };
  outcome.diagnosis = files.compute(study, [&] { return diagnose(problem, rules, context, tell); });
  outcome.evidence = evidence_of_candidates(study, candidates, outcome.diagnosis, settings, context);
  outcome.seconds = steady_seconds() - start;
  return outcome;
}

}  // namespace

DiagnoseOutcome diagnose(const Study& study, const RunSettings& settings, const DiagnoseChoices& choices) {
  std::vector<std::string> names = diagnosis_names();
  names.insert(names.end(), {k_diagnosis_log, k_diagnosis_journal});
  require_own(settings.folder, std::move(names), paths_of(study));
  require_ranks(study, settings);
  return without_earlier(settings.folder, earlier_results(settings.folder),
                         [&] { return diagnose_here(study, settings, choices); });
}

}  // namespace mottle::study
