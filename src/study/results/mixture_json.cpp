#include "study/results/mixture_json.hpp"

namespace mottle::study {
namespace {

Json interval_json(const Eigen::MatrixXd& ends) {
  return ends.size() > 0 ? to_json_rows(ends) : Json(nullptr);
}

Json component_json(const Batch& batch) {
  return {{"weight", batch.weight},
          {"mean", to_json(batch.mean)},
          {"std", to_json(batch.std)},
          {"correlation", to_json_rows(batch.correlation)},
          {"mean_ci95", interval_json(batch.mean_interval)},
          {"std_ci95", interval_json(batch.std_interval)},
          {"specimens", batch.specimens}};
}

Json assignment_json(const MixtureFindings& found, const TestData& tests, Eigen::Index specimen) {
  const Eigen::Index batches = found.probabilities.cols() - 1;
  const Eigen::Index own = found.batch_of(specimen);
  return {{"specimen", tests.number_of(specimen)},
          {"component", own < 0 ? Json(nullptr) : Json(own + 1)},
          {"probabilities", to_json(found.probabilities.row(specimen).head(batches).transpose())},
          {"outlier_probability", number_json(found.probabilities(specimen, batches))}};
}

Json test_json(const ComponentsTest& test) {
  return {{"components", test.components},
          {"statistic", number_json(test.statistic)},
          {"critical", number_json(test.critical)},
          {"p_value", test.p_value},
          {"samples", test.samples},
          {"refused", test.is_refused}};
}

}  // namespace

void add_mixture(const UpdatingResult& result, const TestData& tests, Json& json) {
  json["components"] = Json::array();
  json["assignments"] = Json::array();
  json["mixture"] = nullptr;
  if (!result.mixture) return;
  const MixtureFindings& found = *result.mixture;
  for (const Batch& batch : found.batches) json["components"].push_back(component_json(batch));
  for (Eigen::Index s = 0; s < found.probabilities.rows(); ++s) {
    json["assignments"].push_back(assignment_json(found, tests, s));
  }
  json["mixture"] = {{"number", found.is_number_given ? "given" : "tested"},
                     {"tests", Json::array()},
                     {"detectable_distance", found.detectable ? Json(*found.detectable) : Json(nullptr)},
                     {"power", found.tests.empty() ? Json(nullptr) : Json(0.8)}};
  for (const ComponentsTest& test : found.tests) json["mixture"]["tests"].push_back(test_json(test));
}

}  // namespace mottle::study
