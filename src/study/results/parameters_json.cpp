// The parameters of result.json: what a study says of them before anything is computed.
#include "study/results/result_json.hpp"

namespace mottle {
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

const char* scale_name(NormalScale::Kind kind) {
  switch (kind) {
    case NormalScale::Kind::log:
      return "log";
    case NormalScale::Kind::logit:
      return "logit";
    case NormalScale::Kind::identity:
      break;
  }
  return "identity";
}

}  // namespace

Json parameters_json(const ParameterSpace& space) {
  const Eigen::MatrixXd covariance = space.prior().covariance();
  Json units = Json::array();
  Json bounds = Json::array();
  Json scales = Json::array();
  Json marginals = Json::array();
  for (const Parameter& parameter : space.parameters()) {
    units.push_back(parameter.unit);
    bounds.push_back(bounds_json(parameter));
    scales.push_back(scale_name(parameter.scale.kind));
  }
  for (const Distribution& marginal : space.prior().marginals()) marginals.push_back(distribution_json(marginal));
  return {{"names", space.names()},
          {"units", units},
          {"bounds", bounds},
          {"scale", scales},
          {"prior", marginals},
          {"prior_mean", to_json(space.prior().mean())},
          {"prior_std", to_json(covariance.diagonal().cwiseSqrt())}};
}

}  // namespace mottle
