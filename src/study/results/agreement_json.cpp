// `agreement` of result.json.
#include "study/results/agreement.hpp"

namespace mottle::study {
namespace {

Json claim_json(const std::optional<bool>& claim) {
  return claim ? Json(*claim) : Json(nullptr);
}

Json comparison_json(const CloudComparison& comparison) {
  return {{"mean_difference", number_json(comparison.mean_difference)},
          {"mean_error", number_json(comparison.mean_error)},
          {"standard_errors", number_json(comparison.standard_errors)},
          {"std_ratio", number_json(comparison.std_ratio)}};
}

Json output_json(const OutputAgreement& output, const Quantity& quantity) {
  return {{"name", quantity.name()},
          {"unit", quantity.unit},
          {"initial", comparison_json(output.initial)},
          {"final", comparison_json(output.final)},
          {"critical_standard_errors", number_json(output.critical_standard_errors)},
          {"std_ratio_range", {number_json(output.min_std_ratio), number_json(output.max_std_ratio)}},
          {"is_mean_reproduced", claim_json(output.is_mean_reproduced)},
          {"is_scatter_reproduced", claim_json(output.is_scatter_reproduced)}};
}

Json region_json(const std::optional<RegionAgreement>& region) {
  if (!region) return nullptr;
  return {{"probability", region->probability},
          {"tests", region->tests},
          {"initial_inside", region->initial ? Json(*region->initial) : Json(nullptr)},
          {"final_inside", region->final},
          {"least_inside", region->min_inside},
          {"is_reproduced", region->is_judged ? Json(region->is_reproduced()) : Json(nullptr)}};
}

}  // namespace

Json agreement_json(const Agreement& agreement, const std::vector<Quantity>& outputs) {
  Json list = Json::array();
  for (const OutputAgreement& output : agreement.outputs) {
    list.push_back(output_json(output, outputs[static_cast<std::size_t>(output.output)]));
  }
  return {{"chance", k_chance},
          {"outputs", std::move(list)},
          {"region", region_json(agreement.region)},
          {"are_means_reproduced", agreement.are_means_reproduced()},
          {"is_scatter_reproduced", agreement.is_scatter_reproduced()}};
}

}  // namespace mottle::study
