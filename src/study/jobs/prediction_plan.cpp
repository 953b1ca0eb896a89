#include "study/jobs/prediction_plan.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/model/ranked_model.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/key_error.hpp"
#include "study/input/noise_rules.hpp"
#include "study/tests/shape_size.hpp"
#include "study/tests/table_values.hpp"

namespace mottle::study {

namespace {

/// The study whose model and outputs are the predicted ones.
Study predicted_study(const Study& study) {
  Study other = study;
  other.outputs = study.predict->outputs;
  other.outputs_key = "predict";
  for (const auto& [given, value] : study.predict->overrides) {
    const std::string target = study.model->target_key(given);
    for (const StudyParameter& parameter : study.parameters.list) {
      const bool is_owned = std::any_of(parameter.targets.begin(), parameter.targets.end(),
                                        [&](const std::string& own) { return study.model->target_key(own) == target; });
      require_key(!is_owned, "predict.model", "'{}' is what parameter '{}' acts on: its value comes from the update",
                  given, parameter.name);
    }
    other.model = other.model->with_number(target, value);
  }
  if (study.predict->held_out) {
    other.test = StudyTest{.key = "predict.held_out", .files = {*study.predict->held_out}};
    const bool is_by_frequency = study.test && study.test->pairing == TestPairing::frequency;
    if (is_by_frequency) other.test->pairing = TestPairing::frequency;
  }
  const bool is_as_updated = other.outputs.shape_size == ShapeSize::by_tests && !study.outputs.shape_modes.empty();
  other.outputs.shape_size = is_as_updated ? study.outputs.shape_size : shape_size_of(other);
  return other;
}

/// Noise of the predicted outputs: given, else that of the update's output of the same name, else none.
Eigen::VectorXd noise_of(const PredictionPlan& plan, const UpdatingProblem& problem, const UpdatingResult& result) {
  Eigen::VectorXd noise = plan.repeatability;
  const std::vector<Quantity>& used = problem.model.outputs();
  const std::vector<Quantity>& outputs = plan.made.model->outputs();
  for (Eigen::Index k = 0; k < noise.size(); ++k) {
    if (!std::isnan(noise(k))) continue;
    noise(k) = 0.0;
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (used[j].name() != outputs[static_cast<std::size_t>(k)].name()) continue;
      const auto output = static_cast<Eigen::Index>(j);
      noise(k) = result.noise_covariance.size() > 0 ? std::sqrt(result.noise_covariance(output, output))
                                                    : problem.tests.repeatability_std(output);
    }
  }
  return noise;
}

/// The model's error of the predicted outputs: for a tested output of the structure as tested, the error estimated
/// there; else an independent one with the standard deviation of the output of that name.
std::optional<PredictedError> error_of(const Study& study, const PredictionPlan& plan, const UpdatingProblem& problem,
                                       const UpdatingResult& result, const RunContext& context) {
  if (!problem.tests.has_model_error()) return std::nullopt;
  const std::vector<Quantity>& used = problem.model.outputs();
  const std::vector<Quantity>& outputs = plan.made.model->outputs();
  const auto tested = static_cast<Eigen::Index>(used.size());
  const Eigen::VectorXd known =
      result.model_error ? result.model_error->std : Eigen::VectorXd(problem.tests.model_error_variance().cwiseSqrt());
  PredictedError error{{known, Eigen::VectorXd::Zero(tested), Eigen::MatrixXd::Zero(tested, tested),
                        Eigen::MatrixXd::Zero(problem.space.count(), tested)},
                       std::vector<Eigen::Index>(outputs.size(), -1),
                       Eigen::VectorXd::Zero(static_cast<Eigen::Index>(outputs.size()))};
  if (result.model_error) error.estimate = *result.model_error;
  const bool is_same = study.predict->overrides.empty() && result.model_error.has_value();
  const Eigen::VectorXd values = plan.model->evaluate(result.mean.transpose(), context).outputs.row(0);
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto output = static_cast<Eigen::Index>(k);
    const auto found =
        std::find_if(used.begin(), used.end(), [&](const Quantity& one) { return one.name() == outputs[k].name(); });
    const NoiseRule* rule = rule_for(study.test->model_error, outputs[k].name());
    if (found != used.end()) {
      const auto index = std::distance(used.begin(), found);
      if (is_same) error.tested[k] = index;
      if (!is_same) error.own_std(output) = known(index);
    } else if (rule != nullptr) {
      error.own_std(output) = rule->is_relative ? rule->value * std::abs(values(output)) : rule->value;
    }
  }
  return error;
}

}  // namespace

PredictionPlan plan_prediction(const Study& study, const RunSettings& settings) {
  try {
    const Study other = predicted_study(study);
    PredictionPlan plan{.made = make_model(other, other.parameters, settings)};
    plan.model = std::make_unique<RankedModel>(*plan.made.model, settings.ranks);
    if (study.predict->held_out) plan.held_out = read_tests(other, *plan.made.model);
    const std::vector<Quantity>& outputs = plan.made.model->outputs();
    plan.repeatability = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(outputs.size()), std::nan(""));
    const std::vector<std::string> names = output_names(outputs);
    for (const auto& [name, value] : study.predict->repeatability) {
      const auto found = std::find(names.begin(), names.end(), name);
      require_key(found != names.end(), "predict.repeatability", "{}", unknown_name_message("output", name, names));
      plan.repeatability(std::distance(names.begin(), found)) = value;
    }
    return plan;
  } catch (const KeyError& error) {
    throw InvalidInput(located(study, error));
  }
}

PredictionOutcome run_prediction(const Study& study, const PredictionPlan& plan, const UpdatingProblem& problem,
                                 const UpdatingResult& result, const RunContext& context) {
  const Estimate& estimate = *result.estimate;
  PredictionOutcome outcome{.settings = {.noise_std = noise_of(plan, problem, result),
                                         .model_error = error_of(study, plan, problem, result, context),
                                         .draws = study.predict->draws}};
  outcome.prediction = predict(*plan.model, problem.space, estimate, outcome.settings, context);
  if (plan.held_out) outcome.check = check_held_out(outcome.prediction, estimate, plan.held_out->data.values);
  outcome.notes = prediction_sentences(outcome.prediction, outcome.check ? &*outcome.check : nullptr, estimate,
                                       plan.made.model->outputs(), outcome.settings.level);
  return outcome;
}

}  // namespace mottle::study
