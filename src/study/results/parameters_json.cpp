// The parameters of result.json as the study gives them: priors, bounds and transforms.
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

Json bounds_json(const Parameter& parameter) {
  return Json::array({number_json(parameter.lower_bound), number_json(parameter.upper_bound)});
}

Json distribution_json(const Distribution& distribution) {
  const DistributionSpec& spec = distribution.spec();
  return {{"kind", distribution_kind_info(spec.kind).name},
          {"mean", number_json(spec.mean)},
          {"std", number_json(spec.std)},
          {"lower", number_json(spec.lower)},
          {"upper", number_json(spec.upper)}};
}

Json correlation_intervals_json(const ParameterIntervals& intervals) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < intervals.correlation_lower.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < intervals.correlation_lower.cols(); ++j) {
      row.push_back({number_json(intervals.correlation_lower(i, j)), number_json(intervals.correlation_upper(i, j))});
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Json parameters_json(const ParameterSpace& space) {
  const Eigen::MatrixXd covariance = space.prior().covariance();
  Json units = Json::array();
  Json bounds = Json::array();
  Json transforms = Json::array();
  Json marginals = Json::array();
  for (const Parameter& parameter : space.parameters()) {
    units.push_back(parameter.unit);
    bounds.push_back(bounds_json(parameter));
    transforms.push_back(scale_name(parameter.transform.kind));
  }
  for (const Distribution& marginal : space.prior().marginals()) marginals.push_back(distribution_json(marginal));
  return {{"names", space.names()},
          {"units", units},
          {"bounds", bounds},
          {"scale", transforms},
          {"prior", marginals},
          {"prior_mean", to_json(space.prior().mean())},
          {"prior_std", to_json(covariance.diagonal().cwiseSqrt())}};
}

Json updated_parameters_json(const UpdatingProblem& problem, const UpdatingResult& result) {
  Json parameters = parameters_json(problem.space);
  parameters["mean"] = to_json(result.mean);
  parameters["std"] = to_json(result.covariance.diagonal().cwiseSqrt());
  parameters["covariance"] = to_json_rows(result.covariance);
  parameters["is_population"] = result.is_population;
  parameters["mean_ci95"] = result.intervals ? to_json_rows(result.intervals->mean) : Json(nullptr);
  const bool has_scatter = result.intervals && result.is_population;
  parameters["std_ci95"] = has_scatter ? to_json_rows(result.intervals->std) : Json(nullptr);
  parameters["correlation_ci95"] = has_scatter ? correlation_intervals_json(*result.intervals) : Json(nullptr);
  parameters["mean_curvature_bias"] = result.curvature_bias.size() > 0 ? to_json(result.curvature_bias) : Json(nullptr);
  parameters["intervals_by"] = result.intervals ? Json(result.intervals->made_by) : Json(nullptr);
  Json at_bound = Json::array();
  parameters["location"] = to_json(result.location());
  for (const int side : problem.space.active_bounds(result.location())) {
    at_bound.push_back(side == 0 ? Json(nullptr) : Json(side < 0 ? "lower" : "upper"));
  }
  parameters["at_bound"] = at_bound;
  return parameters;
}

}  // namespace mottle::study
