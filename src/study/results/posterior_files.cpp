#include "study/results/posterior_files.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/formats/tables/csv.hpp"
#include "study/results/posterior_curves.hpp"

namespace mottle::study {
namespace {

/// [chain][draw] of one column.
Json chains_json(const SampledPosterior& posterior, const Eigen::Ref<const Eigen::VectorXd>& column) {
  return to_json_rows(posterior.chains_of(column).transpose());
}

/// Of a chain: what each of its stages did.
Json stages_json(const std::vector<SamplingStage>& stages) {
  Json list = Json::array();
  for (const SamplingStage& stage : stages) {
    list.push_back({{"exponent", stage.exponent},
                    {"effective_samples", stage.effective_samples},
                    {"moves", stage.moves},
                    {"acceptance", stage.acceptance},
                    {"correlation", stage.correlation},
                    {"divergences", stage.divergences}});
  }
  return list;
}

/// [chain][draw][column] of a matrix [chain x draw, column].
Json rows_json(const SampledPosterior& posterior, const Eigen::MatrixXd& values) {
  Json chains = Json::array();
  for (Eigen::Index c = 0; c < posterior.chains; ++c) {
    chains.push_back(to_json_rows(values.middleRows(c * posterior.draws, posterior.draws)));
  }
  return chains;
}

/// null where none is given.
Json given_noise_json(const TestData& tests) {
  Json list = Json::array();
  for (const double std : tests.repeatability_std) list.push_back(std > 0.0 ? number_json(std) : Json(nullptr));
  return list;
}

Json accuracy_json(const PredictiveAccuracy& accuracy) {
  return {{"elpd", number_json(accuracy.elpd)},
          {"standard_error", number_json(accuracy.standard_error)},
          {"effective_parameters", number_json(accuracy.effective_parameters)},
          {"pointwise", to_json(accuracy.pointwise)}};
}

void add_predictive_accuracy(const SampledPosterior& posterior, Json& json) {
  json["leave_one_out"] = nullptr;
  json["waic"] = posterior.waic ? accuracy_json(*posterior.waic) : Json(nullptr);
  if (posterior.leave_one_out) {
    json["leave_one_out"] = accuracy_json(*posterior.leave_one_out);
    json["leave_one_out"]["pareto_k"] = to_json(posterior.leave_one_out->pareto_k);
  }
  json["not_left_out"] = posterior.not_left_out.empty() ? Json(nullptr) : Json(posterior.not_left_out);
}

/// Power of the likelihood that all islands have reached: 1 is the posterior.
double smallest_exponent(const SampledPosterior& posterior) {
  double smallest = 1.0;
  for (const std::vector<SamplingStage>& stages : posterior.stages) {
    smallest = std::min(smallest, stages.empty() ? 0.0 : stages.back().exponent);
  }
  return smallest;
}

}  // namespace

std::string posterior_csv(const SampledPosterior& posterior) {
  std::vector<std::string> header{"chain", "draw"};
  header.insert(header.end(), posterior.names.begin(), posterior.names.end());
  header.emplace_back("log_likelihood");
  const Eigen::Index columns = posterior.values.cols();
  Eigen::MatrixXd rows(posterior.values.rows(), columns + 3);
  for (Eigen::Index c = 0; c < posterior.chains; ++c) {
    const Eigen::Index first = c * posterior.draws;
    const auto draws = static_cast<double>(posterior.draws);
    rows.col(0).segment(first, posterior.draws).setConstant(static_cast<double>(c + 1));
    rows.col(1).segment(first, posterior.draws) =
        Eigen::VectorXd::LinSpaced(posterior.draws, 1.0, draws).array().round();
  }
  rows.middleCols(2, columns) = posterior.values;
  rows.col(columns + 2) = posterior.log_likelihood;
  return format_csv(header, rows);
}

std::string posterior_arviz(const SampledPosterior& posterior, const UpdatingProblem& problem) {
  Json variables = Json::object();
  for (std::size_t k = 0; k < posterior.names.size(); ++k) {
    variables[posterior.names[k]] = chains_json(posterior, posterior.values.col(static_cast<Eigen::Index>(k)));
  }
  Json observed = Json::object();
  Json predicted = Json::object();
  for (std::size_t k = 0; k < problem.model.outputs().size(); ++k) {
    const std::string name = problem.model.outputs()[k].name();
    const auto column = static_cast<Eigen::Index>(k);
    observed[name] = to_json(problem.tests.values.col(column));
    if (posterior.replicates.size() > 0) predicted[name] = chains_json(posterior, posterior.replicates.col(column));
  }
  const bool has_specimens = posterior.specimen_log_likelihood.size() > 0;
  Json json = {{"posterior", std::move(variables)},
               {"log_likelihood",
                {{"tests", has_specimens ? rows_json(posterior, posterior.specimen_log_likelihood)
                                         : chains_json(posterior, posterior.log_likelihood)}}}};
  if (!predicted.empty()) json["posterior_predictive"] = std::move(predicted);
  json["observed_data"] = std::move(observed);
  return one_line(json) + '\n';
}

void add_posterior(const SampledPosterior* posterior, const TestData& tests, Json& result) {
  result["evidence"] = nullptr;
  result["posterior"] = nullptr;
  result["modes"] = Json::array();
  if (posterior == nullptr) return;
  const Evidence& evidence = posterior->evidence;
  if (std::isfinite(evidence.log_evidence))
    result["evidence"] = {{"ln_evidence", number_json(evidence.log_evidence)},
                          {"standard_error", number_json(evidence.standard_error)},
                          {"degrees_of_freedom", evidence.degrees_of_freedom},
                          {"ci95", {number_json(evidence.lower), number_json(evidence.upper)}},
                          {"source", evidence.source == EvidenceSource::islands ? "islands" : "importance-sampling"},
                          {"spread", number_json(evidence.spread)},
                          {"islands", to_json(posterior->chain_log_evidence)},
                          {"noise_std", given_noise_json(tests)},
                          {"model_error_std", to_json(tests.model_error_variance().cwiseSqrt())}};
  std::vector<std::string> names = posterior->names;
  names.emplace_back("log_likelihood");
  Json stages = Json::array();
  for (const std::vector<SamplingStage>& of_chain : posterior->stages) stages.push_back(stages_json(of_chain));
  result["posterior"] = {{"file", "posterior.csv"},
                         {"chains", posterior->chains},
                         {"draws", posterior->draws},
                         {"names", names},
                         {"r_hat", to_json(posterior->r_hat)},
                         {"ess_bulk", to_json(posterior->ess_bulk)},
                         {"ess_tail", to_json(posterior->ess_tail)},
                         {"model_evaluations", posterior->evaluations},
                         {"exponent", smallest_exponent(*posterior)},
                         {"gradients", posterior->gradients},
                         {"trajectories", posterior->trajectories()},
                         {"divergences", posterior->divergences()},
                         {"failed_evaluations", posterior->failed_runs},
                         {"stages", std::move(stages)},
                         {"ranks", rank_histograms(*posterior)},
                         {"predictive", predictive_quantiles(*posterior)}};
  add_predictive_accuracy(*posterior, result["posterior"]);
  for (const PosteriorMode& mode : posterior->modes) {
    result["modes"].push_back({{"probability", mode.probability},
                               {"standard_error", number_json(mode.standard_error)},
                               {"mean", to_json(mode.mean)}});
  }
}

}  // namespace mottle::study
