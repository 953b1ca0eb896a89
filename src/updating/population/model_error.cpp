#include "updating/population/model_error.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {

Eigen::Index TestData::find(int number) const {
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    if (number_of(s) == number) return s;
  }
  return -1;
}

Eigen::VectorXd TestData::model_error_variance() const {
  if (is_model_error_estimated || model_error_std.size() == 0) return Eigen::VectorXd::Zero(values.cols());
  return model_error_std.cwiseAbs2();
}

NoiseModel model_error_model(const UpdatingProblem& problem) {
  if (!problem.tests.has_model_error()) return {};
  const Eigen::Index p = problem.tests.values.cols();
  const auto outputs = static_cast<std::size_t>(p);
  NoiseModel model = known_noise(problem.tests.model_error_variance());
  if (!problem.tests.is_model_error_estimated) return model;
  require_of(p > problem.space.count(), {Subject::Kind::model_error},
             "cannot be estimated, {} outputs are no more than the {} parameters; give it as numbers", p,
             problem.space.count());
  return with_levels(problem, std::move(model), std::vector<bool>(outputs, true));
}

std::string model_error_note(const UpdatingProblem& problem, const ModelError& error) {
  std::vector<std::string> parts;
  constexpr std::size_t k_listed = 12;
  for (std::size_t k = 0; k < std::min(problem.model.outputs().size(), k_listed); ++k) {
    const auto place = static_cast<Eigen::Index>(k);
    if (problem.tests.is_model_error_estimated || error.std(place) > 0.0) {
      parts.push_back(fmt::format("{} {:.3g}", problem.model.outputs()[k].name(), error.std(place)));
    }
  }
  const bool is_cut = problem.model.outputs().size() > k_listed;
  std::string text = fmt::format(
      "An error of the model is shared by all specimens and does not decrease with their number; the intervals of "
      "means include it. Its standard deviation, {}: {}{}.",
      error.degrees_of_freedom.empty() ? "as given" : "estimated", join(parts), is_cut ? ", ..." : "");
  if (error.degrees_of_freedom.empty()) return text;
  std::vector<std::string> counts;
  for (const double degrees_of_freedom : error.degrees_of_freedom)
    counts.push_back(fmt::format("{:.1f}", degrees_of_freedom));
  return text + fmt::format(
                    " This estimate has only {} degrees of freedom, whatever the number of specimens: the outputs "
                    "in excess of those that the parameters need.",
                    join(counts));
}

void note_model_error(const UpdatingProblem& problem, const std::string& method, const std::string& use,
                      UpdatingResult& result) {
  if (!problem.tests.has_model_error()) return;
  if (problem.tests.is_model_error_estimated) {
    result.notes.push_back(fmt::format(
        "model_error = \"estimated\" is not used: method '{}' does not estimate it; give it as numbers, or use "
        "method = \"maximum-likelihood\".",
        method));
    return;
  }
  result.notes.push_back("The model's error (model_error) " + use);
}

std::optional<ModelError> given_model_error(const UpdatingProblem& problem, const Eigen::MatrixXd& gain) {
  const Eigen::VectorXd variance = problem.tests.model_error_variance();
  if (variance.isZero(0.0)) return std::nullopt;
  return ModelError{.std = variance.cwiseSqrt(),
                    .shift = Eigen::VectorXd::Zero(variance.size()),
                    .covariance = variance.asDiagonal(),
                    .gain = -gain};
}

}  // namespace mottle::updating
