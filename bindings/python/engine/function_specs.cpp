#include "function_specs.hpp"

#include "mottle/stats/distributions/default_transform.hpp"

namespace mottle::python {
namespace {

const DistributionKindInfo& kind_of(const ParameterSpec& spec) {
  std::vector<std::string> names;
  for (const DistributionKindInfo& kind : distribution_kinds()) {
    if (kind.name == spec.kind) return kind;
    names.push_back(kind.name);
  }
  throw InvalidInput(
      fmt::format("parameter '{}': {}", spec.name, unknown_name_message("distribution", spec.kind, names)));
}

DistributionSpec prior_of(const ParameterSpec& spec) {
  DistributionSpec distribution{.kind = kind_of(spec).kind};
  for (const std::string& value : kind_of(spec).required) {
    if (value == "mean") distribution.mean = spec.mean;
    if (value == "std") distribution.std = spec.std;
    if (value == "lower") distribution.lower = spec.lower;
    if (value == "upper") distribution.upper = spec.upper;
  }
  return distribution;
}

Distribution distribution_of(const ParameterSpec& spec) {
  try {
    return Distribution(prior_of(spec));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("parameter '{}': {}", spec.name, error.what()));
  }
}

ParameterTransform transform_of(const ParameterSpec& spec) {
  using Kind = ParameterTransform::Kind;
  if (spec.scale.empty()) return default_transform(prior_of(spec));
  for (const Kind kind : {Kind::identity, Kind::log, Kind::logit}) {
    if (spec.scale == scale_name(kind)) return {kind, spec.lower_bound, spec.upper_bound};
  }
  throw InvalidInput(fmt::format("parameter '{}': {}", spec.name,
                                 unknown_name_message("scale", spec.scale, {"identity", "log", "logit"})));
}

}  // namespace

ParameterSpace space_of(const std::vector<ParameterSpec>& specs, const Eigen::MatrixXd& correlation) {
  std::vector<Parameter> parameters;
  std::vector<Distribution> marginals;
  for (const ParameterSpec& spec : specs) {
    parameters.push_back({.name = spec.name,
                          .unit = spec.unit,
                          .lower_bound = spec.lower_bound,
                          .upper_bound = spec.upper_bound,
                          .limit = {.lower = spec.lower_limit},
                          .transform = {}});
    marginals.push_back(distribution_of(spec));
    parameters.back().transform = transform_of(spec);  // of a prior that is valid
  }
  if (correlation.size() == 0) return {std::move(parameters), JointDistribution(std::move(marginals))};
  return {std::move(parameters), JointDistribution(std::move(marginals), correlation)};
}

Quantity quantity_of(const OutputSpec& spec) {
  const auto numbered = [&](std::size_t stem) {
    int number = 0;
    for (const char c : spec.name.substr(stem)) {
      if (c < '0' || c > '9' || number > 99999) return 0;
      number = 10 * number + (c - '0');
    }
    return number;
  };
  if (spec.name.starts_with("f") && numbered(1) > 0) return natural_frequency(numbered(1), spec.unit);
  if (spec.name.starts_with("lambda") && numbered(6) > 0) return natural_eigenvalue(numbered(6), spec.unit);
  return named_quantity(spec.name, spec.unit);
}

std::vector<std::string> leave_out_empty(TestData& tests) {
  std::vector<Eigen::Index> kept;
  std::vector<std::string> empty;
  for (Eigen::Index s = 0; s < tests.values.rows(); ++s) {
    if (tests.values.row(s).array().isNaN().all()) {
      empty.push_back(fmt::format("{}", s + 1));
    } else {
      kept.push_back(s);
      tests.numbers.push_back(static_cast<int>(s) + 1);
    }
  }
  require(!kept.empty(), "tests: there is no specimen with a value; give a row for each");
  if (empty.empty()) return {};
  tests.values = Eigen::MatrixXd(tests.values(kept, Eigen::all));
  return {fmt::format(
      "Specimens without any value are left out, {}: specimen {}; the others keep the numbers of their rows.",
      empty.size(), join(empty))};
}

}  // namespace mottle::python
