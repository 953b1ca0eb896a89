#include "study/results/prediction_files.hpp"

#include "mottle/formats/tables/csv.hpp"

namespace mottle::study {
namespace {

Json histograms_json(const std::vector<HeldOutCheck::Histogram>& histograms) {
  Json list = Json::array();
  for (const HeldOutCheck::Histogram& histogram : histograms) {
    list.push_back({{"counts", histogram.counts}, {"expected_range", {histogram.fewest, histogram.most}}});
  }
  return list;
}

Json check_json(const HeldOutCheck& check, double joint_critical) {
  return {{"specimens", check.transforms.rows()},
          {"coverage", to_json(check.coverage)},
          {"joint_coverage", number_json(check.joint_coverage)},
          {"joint_critical", number_json(joint_critical)},
          {"squared_distances", to_json(check.distances)},
          {"transforms", to_json_rows(check.transforms)},
          {"scores", to_json_rows(check.scores)},
          {"histograms", histograms_json(check.histograms)},
          {"least_inside", std::vector<int>(check.min_inside.begin(), check.min_inside.end())},
          {"uniformity_p_values", to_json(check.uniformity)},
          {"adjusted_p_value", number_json(check.adjusted_p)}};
}

}  // namespace

std::string prediction_csv(const PredictionOutcome& outcome, const std::vector<Quantity>& outputs) {
  const Prediction& prediction = outcome.prediction;
  const HeldOutCheck* check = outcome.check ? &*outcome.check : nullptr;
  const Eigen::Index p = prediction.mean.size();
  std::vector<std::string> header{"mean", "std", "lower95", "upper95"};
  Eigen::MatrixXd values(p, check != nullptr ? 6 : 4);
  values.leftCols(4) << prediction.mean, prediction.covariance.diagonal().cwiseSqrt(), prediction.interval;
  if (check != nullptr) {
    header.insert(header.end(), {"held_out_coverage", "uniformity_p"});
    values.rightCols(2) << check->coverage, check->uniformity;
  }
  header.insert(header.end(), {"output", "unit"});
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (const Quantity& output : outputs) {
    names.push_back(output.name());
    units.push_back(output.unit);
  }
  return format_csv(header, values, {names, units});
}

Json prediction_json(const PredictionOutcome& outcome, const std::vector<Quantity>& outputs,
                     const std::map<std::string, double>& overrides) {
  const Prediction& prediction = outcome.prediction;
  Json json = outputs_json(outputs);
  json["mean"] = to_json(prediction.mean);
  json["std"] = to_json(prediction.covariance.diagonal().cwiseSqrt());
  json["covariance"] = to_json_rows(prediction.covariance);
  json["interval95"] = to_json_rows(prediction.interval);
  json["joint_critical"] = number_json(prediction.joint_critical);
  json["noise_std"] = to_json(outcome.settings.noise_std);
  json["draws"] = outcome.settings.draws;
  json["draws_left_out"] = prediction.impossible;
  json["model_evaluations"] = prediction.model_evaluations;
  json["model"] = overrides;
  json["held_out"] = outcome.check ? check_json(*outcome.check, prediction.joint_critical) : Json(nullptr);
  json["notes"] = outcome.notes;
  return json;
}

}  // namespace mottle::study
