#include "study/results/posterior_files.hpp"

#include "mottle/formats/tables/csv.hpp"

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
                    {"correlation", stage.correlation}});
  }
  return list;
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
  for (std::size_t k = 0; k < problem.model.outputs().size(); ++k) {
    observed[problem.model.outputs()[k].name()] = to_json(problem.tests.values.col(static_cast<Eigen::Index>(k)));
  }
  const Json json = {{"posterior", std::move(variables)},
                     {"log_likelihood", {{"tests", chains_json(posterior, posterior.log_likelihood)}}},
                     {"observed_data", std::move(observed)}};
  return one_line(json) + '\n';
}

void add_posterior(const SampledPosterior* posterior, Json& result) {
  result["evidence"] = nullptr;
  result["posterior"] = nullptr;
  result["modes"] = Json::array();
  if (posterior == nullptr) return;
  const Evidence& evidence = posterior->evidence;
  result["evidence"] = {{"ln_evidence", number_json(evidence.log_evidence)},
                        {"standard_error", number_json(evidence.standard_error)},
                        {"ci95", {number_json(evidence.lower), number_json(evidence.upper)}},
                        {"spread", number_json(evidence.spread)}};
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
                         {"failed_evaluations", posterior->failed_runs},
                         {"stages", std::move(stages)}};
  for (const PosteriorMode& mode : posterior->modes) {
    result["modes"].push_back({{"probability", mode.probability},
                               {"standard_error", number_json(mode.standard_error)},
                               {"mean", to_json(mode.mean)}});
  }
}

}  // namespace mottle::study
