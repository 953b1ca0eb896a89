// diagnosis.json.
#include "study/results/diagnosis_json.hpp"

#include "study/results/diagnosis_names.hpp"
#include "study/results/evidence_json.hpp"
#include "study/results/proposed_toml.hpp"

namespace mottle::study {
namespace {

Json detectability_json(const Detectability& detectability) {
  return {{"name", detectability.name},
          {"nominal", detectability.nominal},
          {"scale", detectability.scale},
          {"visibility", number_json(detectability.visibility)},
          {"own_share", number_json(detectability.own_share)},
          {"variance_inflation", number_json(detectability.inflation)}};
}

Json fit_json(const CandidateFit& fit) {
  if (!fit.failure.empty()) return {{"failure", fit.failure}};
  return {{"gain", number_json(fit.log_likelihood_increase)},
          {"bic", number_json(fit.bic)},
          {"p_value", number_json(fit.p_value)},
          {"adjusted_p_value", number_json(fit.adjusted_p)},
          {"mean", number_json(fit.mean)},
          {"std", number_json(fit.standard_deviation)},
          {"needed", number_json(fit.needed)},
          {"possible", fit.is_possible},
          {"within_bounds", fit.is_within},
          {"converged", fit.converged}};
}

const char* kind_name(const CandidateFit& fit) {
  return fit.is_random ? "freed" : "shifted";
}

void add_fits(const CandidateFinding& finding, Json& json) {
  json["bic"] = number_json(finding.bic());
  json["best"] = kind_name(finding.answer());
  json["linear"] = fit_json(finding.linear);
  json["linear"]["kind"] = kind_name(finding.linear);
  json["fitted"] = finding.is_fitted();
  json["shifted"] = fit_json(finding.fixed);
  json["freed"] = fit_json(finding.random);
  json["screened_out"] = finding.is_screened_out;
}

Json candidate_json(const CandidateFinding& finding, const std::vector<std::string>& targets) {
  Json json = detectability_json(finding.detectability);
  json["targets"] = targets;
  add_fits(finding, json);
  json["inseparable"] = finding.inseparable;
  json["residuals"] = to_json(finding.answer().residuals);
  return json;
}

Json rounds_json(const Diagnosis& diagnosis) {
  Json rounds = Json::array();
  for (const DiagnosisRound& round : diagnosis.later_rounds) {
    Json candidates = Json::array();
    for (const CandidateFinding& finding : round.candidates) {
      Json candidate = {{"name", finding.detectability.name}};
      add_fits(finding, candidate);
      candidates.push_back(std::move(candidate));
    }
    rounds.push_back({{"beside", round.beside}, {"candidates", candidates}});
  }
  return rounds;
}

/// null where the study does not ask for it.
Json candidates_by_evidence_json(const DiagnosisEvidence& evidence) {
  if (evidence.models.empty()) return nullptr;
  Json models = Json::array();
  for (const ModelEvidence& model : evidence.models) {
    Json json = {{"candidate", model.candidate.empty() ? Json(nullptr) : Json(model.candidate)}};
    if (model.failure.empty()) {
      add_evidence_among(model.evidence, model.against, json);
      json["converged"] = model.is_converged;
      json["model_evaluations"] = model.model_evaluations;
    } else {
      json["failure"] = model.failure;
    }
    models.push_back(std::move(json));
  }
  return {{"method", evidence.method}, {"models", models}};
}

}  // namespace

Json proposed_json(const Diagnosis& diagnosis) {
  Json proposed = Json::array();
  for (const ProposedParameter& parameter : diagnosis.proposed) {
    proposed.push_back({{"name", parameter.name},
                        {"given", parameter.is_given},
                        {"scatter", parameter.is_random},
                        {"bic_lowered", parameter.bic}});
  }
  return proposed;
}

Json diagnosis_json(const DiagnoseOutcome& outcome) {
  const Study& study = outcome.study;
  const Diagnosis& diagnosis = outcome.diagnosis;
  Json json = result_head(study, "diagnose");
  json["stage"] = diagnosis.is_linear ? k_linear_stage : "fitted";
  json["level"] = study.update.level;
  json["headline"] = diagnosis_headline(diagnosis, study.update.level);
  json["explained"] = diagnosis.is_explained;
  json["best"] = diagnosis.candidates.front().detectability.name;
  json["alike"] = diagnosis.alike;
  json["sentences"] = diagnosis.sentences;
  Json names = Json::array();
  for (const StudyParameter& parameter : study.parameters.list) names.push_back(parameter.name);
  json["parameters"] = {{"names", names},
                        {"mean", to_json(diagnosis.mean)},
                        {"std", to_json(diagnosis.standard_deviation)},
                        {"at_bound", diagnosis.at_bound},
                        {"log_likelihood", number_json(diagnosis.log_likelihood)},
                        {"converged", diagnosis.converged},
                        {"unreproduced_specimens", diagnosis.unreproduced},
                        {"directions_out_of_reach", diagnosis.judging},
                        {"residuals", to_json(diagnosis.residuals)}};
  json["outputs"] = {{"names", outcome.output_names}};
  json["given"] = Json::array();
  for (const Detectability& each : diagnosis.given) json["given"].push_back(detectability_json(each));
  json["candidates"] = Json::array();
  Json order = Json::array();
  for (const CandidateFinding& finding : diagnosis.candidates) {
    for (const StudyParameter& parameter : outcome.whole.parameters.list) {
      if (parameter.name != finding.detectability.name) continue;
      json["candidates"].push_back(candidate_json(finding, parameter.targets));
    }
    order.push_back(finding.detectability.name);
  }
  json["cosines"] = {{"names", order}, {"matrix", to_json_rows(diagnosis.cosines)}};
  json["inseparable_degrees"] = diagnosis.inseparable_degrees;
  json["evidence"] = candidates_by_evidence_json(outcome.evidence);
  json["later_rounds"] = rounds_json(diagnosis);
  json["proposed"] = proposed_json(diagnosis);
  json["proposed_toml"] = proposed_toml(outcome);
  json["model_evaluations"] = diagnosis.model_evaluations;
  return json;
}

}  // namespace mottle::study
