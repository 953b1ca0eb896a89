#include "study/results/evidence_json.hpp"

#include <cmath>

namespace mottle::study {

Json evidence_comparison_json(const Comparison& comparison) {
  if (!comparison.evidence) return nullptr;
  Json models = Json::array();
  for (const ComparedModel& one : comparison.evidence->models) {
    models.push_back({{"label", one.label},
                      {"ln_evidence", one.evidence.log_evidence},
                      {"standard_error", one.evidence.standard_error},
                      {"ln_bayes_factor", one.against.log_bayes_factor},
                      {"ln_bayes_factor_standard_error", one.against.standard_error},
                      {"strength", evidence_strength(one.against.log_bayes_factor)},
                      {"probability", one.against.probability},
                      {"probability_ci95", {one.against.lower, one.against.upper}},
                      {"elpd", number_json(one.elpd)},
                      {"elpd_difference", number_json(one.elpd_difference)},
                      {"elpd_difference_standard_error", number_json(one.elpd_standard_error)},
                      {"largest_pareto_k", number_json(one.largest_pareto_k)}});
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
