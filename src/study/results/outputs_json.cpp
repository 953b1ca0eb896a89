// The outputs of result.json: what they are, and the moments of tests and clouds.
#include <algorithm>
#include <cmath>

#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

/// null for an output that only one specimen has.
Json standard_errors_json(const TestMoments& tests) {
  Json list = Json::array();
  for (Eigen::Index k = 0; k < tests.mean.size(); ++k) {
    const double error = std::sqrt(tests.covariance(k, k) / static_cast<double>(tests.count(k)));
    list.push_back(error > 0.0 ? number_json(error) : Json(nullptr));
  }
  return list;
}

void add_test_outputs(Json& outputs, const TestMoments& tests, const UpdatingResult& result) {
  Json counts = Json::array();
  for (const int count : tests.count) counts.push_back(count);
  outputs["test_count"] = counts;
  outputs["test_mean"] = to_json(tests.mean);
  outputs["test_covariance"] = to_json_rows(tests.covariance);
  outputs["test_mean_standard_error"] = standard_errors_json(tests);
  outputs["initial_mean"] = to_json(result.history.front().output_mean);
  outputs["initial_covariance"] = to_json_rows(result.history.front().output_covariance);
  outputs["final_mean"] = to_json(result.history.back().output_mean);
  outputs["final_covariance"] = to_json_rows(result.history.back().output_covariance);
}

/// The model's error: standard deviation, estimate of its shift from the tests, and the standard error of that.
void add_model_error(Json& outputs, const UpdatingResult& result) {
  outputs["model_error_std"] = nullptr;
  outputs["model_error"] = nullptr;
  if (!result.model_error) return;
  const ModelError& error = *result.model_error;
  outputs["model_error_std"] = to_json(error.std);
  Json list = Json::array();
  for (Eigen::Index k = 0; k < error.shift.size(); ++k) {
    list.push_back({{"shift", number_json(error.shift(k))},
                    {"standard_error", number_json(std::sqrt(std::max(error.covariance(k, k), 0.0)))}});
  }
  outputs["model_error"] = std::move(list);
}

}  // namespace

Json outputs_json(const std::vector<Quantity>& outputs) {
  Json names = Json::array();
  Json units = Json::array();
  for (const Quantity& output : outputs) {
    names.push_back(output.name());
    units.push_back(output.unit);
  }
  return {{"names", names}, {"units", units}};
}

Json updated_outputs_json(const UpdatingProblem& problem, const TestMoments& tests, const UpdatingResult& result) {
  Json outputs = outputs_json(problem.model.outputs());
  add_test_outputs(outputs, tests, result);
  outputs["noise_std"] =
      result.noise_covariance.size() > 0 ? to_json(result.noise_covariance.diagonal().cwiseSqrt()) : Json(nullptr);
  add_model_error(outputs, result);
  return outputs;
}

}  // namespace mottle::study
