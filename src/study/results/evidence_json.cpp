#include "study/results/evidence_json.hpp"

#include <cmath>

namespace mottle::study {

void add_evidence_among(const EstimatedEvidence& evidence, const ModelProbability& against, Json& json) {
  json["ln_evidence"] = evidence.log_evidence;
  json["standard_error"] = evidence.standard_error;
  json["ln_bayes_factor"] = against.log_bayes_factor;
  json["ln_bayes_factor_standard_error"] = against.standard_error;
  json["strength"] = evidence_strength(against.log_bayes_factor);
  json["probability"] = against.probability;
  json["probability_ci95"] = {against.lower, against.upper};
}

Json evidence_comparison_json(const Comparison& comparison) {
  if (!comparison.evidence) return nullptr;
  Json models = Json::array();
  for (const ComparedModel& one : comparison.evidence->models) {
    Json json = {{"label", one.label}};
    add_evidence_among(one.evidence, one.against, json);
    json["elpd"] = number_json(one.elpd);
    json["elpd_difference"] = number_json(one.elpd_difference);
    json["elpd_difference_standard_error"] = number_json(one.elpd_standard_error);
    json["largest_pareto_k"] = number_json(one.largest_pareto_k);
    models.push_back(std::move(json));
  }
  Json left_out = Json::array();
  for (const auto& [label, reason] : comparison.evidence->left_out) {
    left_out.push_back({{"label", label}, {"reason", reason}});
  }
  return {{"scale", "Kass and Raftery 1995"},
          {"models", std::move(models)},
          {"not_compared", std::move(left_out)},
          {"warnings", comparison.evidence->warnings}};
}

}  // namespace mottle::study
