#include "study/results/result_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/model/reference_sizes.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/ellipse.hpp"
#include "mottle/stats/moments/spearman.hpp"
#include "mottle/stats/surrogates/regression.hpp"
#include "mottle/stats/tests/hotelling.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/results/estimate_json.hpp"

namespace mottle::study {
namespace {

constexpr double k_ellipse_sigmas = 2.0;
constexpr double k_large_residual = 3.0;  // in standard deviations: of a thousand, three are larger by chance

Json iteration_json(const IterationRecord& state, std::size_t index) {
  return {{"index", index},
          {"distance_euclidean", number_json(state.distance_euclidean)},
          {"distance_mahalanobis", number_json(state.distance_mahalanobis)},
          {"parameter_mean", to_json(state.parameter_mean)},
          {"parameter_std", to_json(state.parameter_covariance.diagonal().cwiseSqrt())},
          {"parameter_covariance", to_json_rows(state.parameter_covariance)},
          {"output_mean", to_json(state.output_mean)},
          {"output_std", to_json(state.output_covariance.diagonal().cwiseSqrt())},
          {"output_covariance", to_json_rows(state.output_covariance)},
          {"failed", state.failures.size()},
          {"rejected_draws", state.rejected_draws},
          {"ellipses", ellipses_json(state.output_mean, state.output_covariance)},
          {"parameter_ellipses", ellipses_json(state.parameter_mean, state.parameter_covariance)}};
}

Json verdict_json(const Verdict& verdict) {
  Json tests = Json::array();
  for (const VerdictTest& test : verdict.tests) {
    tests.push_back({{"name", test.name},
                     {"statistic", number_json(test.statistic)},
                     {"critical", number_json(test.critical)},
                     {"p_value", number_json(test.p_value)},
                     {"passed", test.passed},
                     {"meaning", test.meaning}});
  }
  return {{"conclusion", conclusion_text(verdict.conclusion)},
          {"adequate", adequate_json(verdict.conclusion)},
          {"level", verdict.level},
          {"tests", tests},
          {"reasons", verdict.reasons},
          {"not_tested", verdict.not_tested}};
}

Json identifiability_json(const Identifiability& seen, const std::vector<std::string>& names) {
  Json unseen = Json::array();
  for (const Eigen::VectorXd& direction : seen.unseen_directions) {
    Json weights = Json::object();
    for (std::size_t i = 0; i < names.size(); ++i) weights[names[i]] = direction(static_cast<Eigen::Index>(i));
    unseen.push_back({{"weights", weights}, {"meaning", unseen_text(direction, names)}});
  }
  return {{"rank", seen.rank}, {"singular_values", to_json(seen.singular_values)}, {"unseen_directions", unseen}};
}

/// Fig. 2 of [Mares2006]: the critical value against the number of tests and samples together.
Json t_curve_json(int p, double alpha, int max_total) {
  Json totals = Json::array();
  Json values = Json::array();
  for (int total = p + 2; total <= max_total; total = total < 50 ? total + 1 : static_cast<int>(total * 1.08)) {
    totals.push_back(total);
    values.push_back(hotelling_t_critical(1, total - 1, p, alpha));
  }
  const double limit = hotelling_t_critical(1, 1000000000, p, alpha);
  return {{"n_total", totals}, {"t", values}, {"limit", limit}};
}

Json sample_size_json(const UpdatingProblem& problem, const IterationRecord& last) {
  const auto p = static_cast<int>(problem.model.outputs().size());
  const auto n_test = static_cast<int>(problem.tests.values.rows());
  const auto n_model = static_cast<int>(last.cloud.valid().outputs.rows());
  const bool has_critical = n_test + n_model > p + 1;
  return {{"alpha", problem.level},
          {"n_test", n_test},
          {"n_model", n_model},
          {"t_critical", has_critical ? Json(hotelling_t_critical(n_test, n_model, p, problem.level)) : Json(nullptr)},
          {"monte_carlo_error",
           to_json(last.output_covariance.diagonal().cwiseSqrt() / std::sqrt(static_cast<double>(n_model)))},
          {"curve", t_curve_json(p, problem.level, std::max(2000, 2 * (n_test + n_model)))}};
}

/// [specimen][parameter][2]; null where the method gives none.
Json specimen_intervals_json(const SpecimenEstimates& specimens) {
  if (specimens.lower.size() == 0) return nullptr;
  Json rows = Json::array();
  for (Eigen::Index s = 0; s < specimens.lower.rows(); ++s) {
    Json row = Json::array();
    for (Eigen::Index i = 0; i < specimens.lower.cols(); ++i)
      row.push_back({number_json(specimens.lower(s, i)), number_json(specimens.upper(s, i))});
    rows.push_back(std::move(row));
  }
  return rows;
}

Json specimens_json(const UpdatingResult& result, const TestData& tests) {
  if (!result.specimens) return nullptr;
  const Eigen::MatrixXd& residuals = result.specimens->residuals;
  const auto known = static_cast<double>(residuals.size() - residuals.array().isNaN().count());
  return {{"numbers", tests.numbers},
          {"parameters", to_json_rows(result.specimens->parameters)},
          {"residuals", to_json_rows(residuals)},
          {"interval95", specimen_intervals_json(*result.specimens)},
          {"large_residual", k_large_residual},
          {"expected_large", known * std::erfc(k_large_residual / std::numbers::sqrt2)}};
}

Json options_json(const Study& study, const UpdatingProblem& problem, const Updater& method) {
  Json options = {{"samples", problem.cloud.samples},
                  {"samples_rule", study.update.has_automatic_samples ? "auto" : "given"},
                  {"iterations", problem.iterations},
                  {"tolerance", problem.tolerance},
                  {"starts", problem.starts},
                  {"level", problem.level},
                  {"max_failed", problem.cloud.max_failed}};
  for (const auto& [name, value] : method.options()) {
    std::visit([&options, &name = name](const auto& option) { options[name] = option; }, value);
  }
  return options;
}

}  // namespace

Json number_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json to_json(const Eigen::Ref<const Eigen::VectorXd>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number_json(value));
  return list;
}

Json to_json_rows(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < values.rows(); ++i) rows.push_back(to_json(values.row(i).transpose()));
  return rows;
}

Json result_head(const Study& study, const std::string& command) {
  return {{"schema", 1},        {"mottle", version()},  {"commit", commit()}, {"title", study.title},
          {"command", command}, {"units", study.units}, {"seed", study.seed}};
}

/// Change of each output in percent for one percent of each parameter, at the means of the cloud; null where a mean
/// output is zero. Near a node of a shape: in percent of its largest component.
Json relative_sensitivity_json(const std::vector<Quantity>& outputs, const Eigen::MatrixXd& sensitivity,
                               const Cloud::Valid& cloud) {
  const Eigen::VectorXd x = sample_mean(cloud.samples);
  const Eigen::VectorXd y = sample_mean(cloud.outputs);
  return to_json_rows(reference_sizes(outputs, y).cwiseInverse().asDiagonal() * sensitivity *
                      x.cwiseAbs().asDiagonal());
}

void add_cloud_analysis(const std::vector<Quantity>& outputs, Json& result, const Cloud& regressed,
                        const Cloud& ranked) {
  const Cloud::Valid last = regressed.valid();
  const Cloud::Valid first = ranked.valid();
  const Eigen::Index q = last.samples.cols();
  const Eigen::Index quadratic_terms = 1 + 2 * q + q * (q - 1) / 2;
  result["regression"] = nullptr;
  if (last.samples.rows() > q + 1) {
    try {
      const LinearRegression fit = linear_regression(last.samples, last.outputs);
      result["regression"] = {{"sensitivity", to_json_rows(fit.sensitivity)},
                              {"percent_per_percent", relative_sensitivity_json(outputs, fit.sensitivity, last)},
                              {"standard_error", to_json_rows(fit.standard_error)},
                              {"r_squared", to_json(fit.r_squared)},
                              {"condition", number_json(fit.condition)},
                              {"largest_leverage", number_json(fit.leverage.maxCoeff())}};
      if (last.samples.rows() > 2 * quadratic_terms) {
        const QuadraticRegression quadratic = quadratic_regression(last.samples, last.outputs);
        result["regression"]["r_squared_quadratic"] = to_json(quadratic.r_squared);
      }
    } catch (const InvalidInput&) {
      // Points given by hand may not span all parameters: there is then no sensitivity to report.
    }
  }
  result["spearman"] = first.samples.rows() >= 3 ? to_json_rows(spearman(first.samples, first.outputs)) : Json(nullptr);
}

Json ellipses_json(const Eigen::Ref<const Eigen::VectorXd>& mean, const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  Json list = Json::array();
  if (mean.size() < 2 || !covariance.allFinite()) return list;
  for (const Ellipse& ellipse : pairwise_ellipses(mean, covariance, k_ellipse_sigmas)) {
    list.push_back({{"first", ellipse.first},
                    {"second", ellipse.second},
                    {"centre", to_json(ellipse.centre)},
                    {"semi_major", ellipse.semi_major},
                    {"semi_minor", ellipse.semi_minor},
                    {"angle", ellipse.angle}});
  }
  return list;
}

Json rejected_draws_json(std::int64_t count) {
  return {
      {"count", count},
      {"rule", "a draw with a stiffness or mass <= 0 (damping < 0) is rejected and drawn again from its own stream"}};
}

Json tracking_json(const std::vector<SampleNote>& notes, std::size_t iteration) {
  std::map<std::string, std::size_t> counts;
  for (const SampleNote& note : notes) ++counts[note.text];
  Json json = Json::array();
  for (const auto& [text, samples] : counts) {
    json.push_back({{"iteration", iteration}, {"remark", text}, {"samples", samples}});
  }
  return json;
}

Json failures_json(const std::vector<FailedRun>& failures, std::size_t iteration) {
  Json list = Json::array();
  for (const FailedRun& failure : failures) {
    list.push_back({{"iteration", iteration}, {"sample", failure.sample}, {"reason", failure.reason}});
  }
  return list;
}

namespace {

Json normality_json(const NormalityReport& report, const std::vector<std::string>& names) {
  Json json = {{"p_value", report.test.p_value},
               {"level", report.level},
               {"is_remarkable", report.is_remarkable},
               {"joint", nullptr},
               {"parameters", Json::array()}};
  if (report.test.is_joint_tested) {
    json["joint"] = {{"henze_zirkler", report.test.henze_zirkler}, {"p_value", report.test.henze_zirkler_p}};
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const VariableNormality& variable = report.test.variables[i];
    Json own = {{"name", names[i]}, {"reliability", variable.reliability}, {"p_value", nullptr}};
    if (variable.is_tested) {
      own["p_value"] = variable.probabilities.p_value;
      own["shapiro_wilk"] = variable.statistics.shapiro_wilk;
      own["skewness"] = variable.statistics.skewness;
      own["two_batches"] = {{"statistic", variable.statistics.two_batches},
                            {"p_value", variable.probabilities.two_batches}};
    }
    own["suggestion"] = report.suggestions[i].empty() ? Json(nullptr) : Json(report.suggestions[i]);
    json["parameters"].push_back(std::move(own));
  }
  return json;
}

}  // namespace

Json update_result_json(const Study& study, const StudyTests& tests, const UpdatingProblem& problem,
                        const Updater& method, const UpdatingResult& result, const Verdict& verdict) {
  const TestMoments moments = test_moments(problem.tests);
  const IterationRecord& first = result.history.front();
  const IterationRecord& last = result.history.back();
  Json json = result_head(study, "update");
  json["method"] = study.update.method;
  json["status"] = status_text(result.status);
  json["message"] = result.message;
  json["parameters"] = updated_parameters_json(problem, result);
  add_estimate(problem, result, json["parameters"]);
  json["outputs"] = updated_outputs_json(problem, moments, result);
  json["iterations"] = Json::array();
  Json failures = Json::array();
  Json tracking = Json::array();
  std::int64_t rejected = 0;
  for (std::size_t i = 0; i < result.history.size(); ++i) {
    json["iterations"].push_back(iteration_json(result.history[i], i));
    for (Json& failure : failures_json(result.history[i].failures, i)) failures.push_back(std::move(failure));
    for (Json& remark : tracking_json(result.history[i].notes, i)) tracking.push_back(std::move(remark));
    rejected += result.history[i].rejected_draws;
  }
  json["outliers"] = Json::array();
  for (const Outlier& one : result.outliers) {
    json["outliers"].push_back(
        {{"specimen", problem.tests.number_of(one.sample)}, {"distance", one.distance}, {"p_value", one.p_value}});
  }
  json["normality"] = result.normality ? normality_json(*result.normality, problem.space.names()) : Json(nullptr);
  json["other_solutions"] = Json::array();
  for (const OtherSolution& other : result.other_solutions) {
    json["other_solutions"].push_back(
        {{"mean", to_json(other.mean)},
         {"std", other.std.size() > 0 ? to_json(other.std) : Json(nullptr)},
         {"mean_ci95", other.mean_interval.size() > 0 ? to_json_rows(other.mean_interval) : Json(nullptr)},
         {"weight", other.weight}});
  }
  json["search"] =
      result.search ? Json({{"starts", result.search->starts}, {"settled", result.search->is_settled}}) : Json(nullptr);
  json["specimens"] = specimens_json(result, problem.tests);
  json["test_ellipses"] = ellipses_json(moments.mean, moments.covariance);
  add_cloud_analysis(problem.model.outputs(), json, last.cloud, first.cloud);
  json["sample_size"] = sample_size_json(problem, last);
  json["verdict"] = verdict_json(verdict);
  const std::optional<Identifiability> seen = identify(problem, result);
  json["identifiability"] = seen ? identifiability_json(*seen, problem.space.names()) : Json(nullptr);
  json["model_evaluations"] = result.model_evaluations;
  json["rejected_draws"] = rejected_draws_json(rejected);
  json["failed_evaluations"] = failures;
  json["tracking"] = tracking;
  json["options"] = options_json(study, problem, method);
  json["notes"] = Json::array();
  for (const auto* list : {&result.warnings, &result.notes, &tests.notes}) {
    for (const std::string& note : *list) json["notes"].push_back(note);
  }
  for (const TestDoubt& doubt : tests.doubts) json["notes"].push_back(doubt.sentence);
  return json;
}

Json adequate_json(Conclusion conclusion) {
  return conclusion == Conclusion::undecided ? Json(nullptr) : Json(conclusion == Conclusion::adequate);
}

std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string pretty(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace mottle::study
