#include "study/jobs/candidate_evidence.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/surrogate_update.hpp"
#include "study/jobs/candidates.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/jobs/update_plan.hpp"

namespace mottle::study {
namespace {

Study with_evidence(const Study& study) {
  Study sampled = study;
  sampled.predict.reset();
  if (study.update.method != "bayes") sampled.update.method = "hierarchical";
  return sampled;
}

/// Updates, and takes the evidence alone.
void sample(const Study& study, RunSettings settings, const RunContext& context, ModelEvidence& found) {
  settings.folder.clear();
  const UpdatePlan plan = plan_update(study, settings);
  const JournalledModel model(*plan.made.model, {}, study_fingerprint(study, plan.made), false, settings.ranks);
  const UpdatingProblem problem = problem_of(study, plan, model);
  const UpdatingResult result = study.surrogate ? SurrogateUpdate(problem, *study.surrogate).run(*plan.method, context)
                                                : plan.method->update(problem, context);
  if (result.status == UpdatingStatus::stopped) throw Stopped(result.message);
  found.evidence = result.posterior->evidence;
  found.is_converged = result.status == UpdatingStatus::converged;
  found.model_evaluations = result.model_evaluations;
}

/// The parameters alone first, then the candidates that are best by BIC.
std::vector<ModelEvidence> models_to_compare(const Study& study, const Diagnosis& diagnosis) {
  std::vector<ModelEvidence> models(1);
  for (const CandidateFinding& finding : diagnosis.candidates) {
    if (static_cast<int>(models.size()) > study.diagnose.evidence) break;
    if (finding.better().failure.empty()) models.push_back({.candidate = finding.detectability.name});
  }
  return models;
}

}  // namespace

DiagnosisEvidence evidence_of_candidates(const Study& study, const std::vector<StudyParameter>& candidates,
                                         const Diagnosis& diagnosis, const RunSettings& settings,
                                         const RunContext& context) {
  if (study.diagnose.evidence == 0) return {};
  const Study base = with_evidence(study);
  DiagnosisEvidence compared{.method = base.update.method, .models = models_to_compare(study, diagnosis)};
  std::vector<EstimatedEvidence> evidences;
  if (compared.models.size() == 1) {
    compared.models.front().failure = "no candidate has a fit, so that there is no model to compare it with";
    return compared;
  }
  for (ModelEvidence& model : compared.models) {
    const auto candidate = std::ranges::find(candidates, model.candidate, &StudyParameter::name);
    context.phase({.name = model.candidate.empty() ? "evidence of the parameters alone"
                                                   : fmt::format("evidence with {}", model.candidate)});
    try {
      sample(candidate == candidates.end() ? base : with_candidates(base, {*candidate}), settings, context, model);
      evidences.push_back(model.evidence);
    } catch (const InvalidInput& error) {
      model.failure = error.what();
    } catch (const SystemFailure& error) {
      model.failure = error.what();
    }
  }
  if (evidences.size() < 2) {
    for (ModelEvidence& model : compared.models) {
      if (model.failure.empty()) model.failure = "no other model has an evidence that it could be compared with";
    }
    return compared;
  }
  const std::vector<ModelProbability> probabilities = compare_evidences(evidences);
  auto next = probabilities.begin();
  for (ModelEvidence& model : compared.models) {
    if (model.failure.empty()) model.against = *next++;
  }
  return compared;
}

}  // namespace mottle::study
