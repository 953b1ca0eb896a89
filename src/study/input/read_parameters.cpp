// [[parameter]] and [correlation] of a study.
#include <algorithm>
#include <cmath>
#include <set>

#include "mottle/core/text.hpp"
#include "mottle/stats/distributions/default_transform.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/study_sections.hpp"

namespace mottle::study {
namespace {

DistributionSpec read_distribution(TomlReader reader) {
  const auto& kinds = distribution_kinds();
  std::vector<std::string> names;
  for (const auto& kind : kinds) names.emplace_back(kind.name);
  reader.text("kind");
  const auto& kind = kinds[reader.choice("kind", names, 0)];
  DistributionSpec spec{.kind = kind.kind};
  for (const auto& value : kind.required) {
    const double number = reader.number(value, {});
    if (value == "mean") spec.mean = number;
    if (value == "std") spec.std = number;
    if (value == "lower") spec.lower = number;
    if (value == "upper") spec.upper = number;
  }
  reader.finish();
  try {
    Distribution{spec};
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", reader.where(), error.what()));
  }
  return spec;
}

/// The transform under which the population is normal: key `scale`, else the prior's; bounds and distribution are
/// already read.
ParameterTransform read_transform(TomlReader& reader, const StudyParameter& parameter) {
  using Kind = ParameterTransform::Kind;
  if (!reader.has("scale")) {
    reader.raw("scale");  // is known
    return default_transform(parameter.distribution);
  }
  const std::vector<Kind> kinds{Kind::identity, Kind::log, Kind::logit};
  std::vector<std::string> names(kinds.size());
  std::ranges::transform(kinds, names.begin(), scale_name);
  const ParameterTransform transform{kinds[reader.choice("scale", names, 0)], parameter.lower_bound,
                                     parameter.upper_bound};
  const double mean = Distribution(parameter.distribution).mean();
  if (transform.kind == Kind::log && !(mean > 0.0)) {
    reader.fail("scale", fmt::format("\"log\" is for positive parameters, the distribution's mean is {}; give scale = "
                                     "\"identity\", or \"logit\" with bounds",
                                     mean));
  }
  if (transform.kind == Kind::logit && !(std::isfinite(transform.lower) && std::isfinite(transform.upper))) {
    reader.fail("scale", "\"logit\" is taken between the bounds, which are missing; give bounds = [lower, upper]");
  }
  if (transform.kind == Kind::logit && !(transform.lower < mean && mean < transform.upper)) {
    reader.fail("scale", fmt::format("\"logit\" needs the distribution's mean, {}, inside the bounds [{}, {}]", mean,
                                     transform.lower, transform.upper));
  }
  return transform;
}

}  // namespace

StudyParameter read_parameter(TomlReader& reader, bool has_targets) {
  StudyParameter parameter;
  parameter.name = reader.name("name");
  const std::set<std::string> taken{"", "status", "iteration"};  // columns of the result files
  if (taken.contains(parameter.name)) reader.fail_value("name", "a name other than 'status' and 'iteration'");
  if (!has_targets) {
    parameter.targets = {reader.text_or("target", parameter.name)};
  } else {
    parameter.targets = reader.texts("target");
    parameter.is_factor = reader.flag_or("relative", false);
  }
  parameter.distribution = read_distribution(reader.table("distribution"));
  if (reader.raw("bounds") != nullptr) {
    const std::vector<double> bounds = reader.numbers("bounds");
    if (bounds.size() != 2 || !(bounds[0] < bounds[1])) {
      reader.fail_value("bounds", "two numbers, the lower first, like [0.5, 3.0]");
    }
    parameter.lower_bound = bounds[0];
    parameter.upper_bound = bounds[1];
  }
  parameter.transform = read_transform(reader, parameter);
  reader.finish();
  return parameter;
}

namespace {

Eigen::MatrixXd read_matrix(TomlReader& reader, Eigen::Index size) {
  const std::string allowed = fmt::format("{0} rows of {0} numbers", size);
  const toml::node* node = reader.raw("matrix");
  const toml::array* rows = node->as_array();
  if (rows == nullptr || static_cast<Eigen::Index>(rows->size()) != size) reader.fail_value("matrix", allowed);
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const toml::array* row = rows->get(static_cast<std::size_t>(i))->as_array();
    if (row == nullptr || static_cast<Eigen::Index>(row->size()) != size) reader.fail_value("matrix", allowed);
    for (Eigen::Index j = 0; j < size; ++j) {
      const toml::node& cell = *row->get(static_cast<std::size_t>(j));
      if (!cell.is_number()) reader.fail_value("matrix", allowed);
      matrix(i, j) = *cell.value<double>();
    }
  }
  return matrix;
}

Eigen::MatrixXd read_pairs(TomlReader& reader, const std::vector<std::string>& names) {
  const auto size = static_cast<Eigen::Index>(names.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  std::set<std::set<std::string>> seen;
  for (TomlReader& pair : reader.tables("pairs")) {
    const std::vector<std::string> between = pair.texts("between");
    if (between.size() != 2 || between[0] == between[1]) pair.fail_value("between", "two different parameters");
    Eigen::Index index[2] = {0, 0};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto found = std::find(names.begin(), names.end(), between[k]);
      if (found == names.end()) pair.fail("between", unknown_name_message("parameter", between[k], names));
      index[k] = std::distance(names.begin(), found);
    }
    if (!seen.insert({between.begin(), between.end()}).second) {
      pair.fail("between", fmt::format("the pair of '{}' and '{}' is given twice", between[0], between[1]));
    }
    const double value = pair.number("value", {.lower = -1.0, .upper = 1.0});
    matrix(index[0], index[1]) = value;
    matrix(index[1], index[0]) = value;
    pair.finish();
  }
  return matrix;
}

}  // namespace

StudyParameters read_parameters(TomlReader& owner, const ModelSource& model) {
  StudyParameters parameters;
  std::set<std::string> seen;
  std::vector<std::string> names;
  for (TomlReader& reader : owner.tables("parameter")) {
    parameters.list.push_back(read_parameter(reader, model.has_targets()));
    names.push_back(parameters.list.back().name);
    if (!seen.insert(names.back()).second) {
      reader.fail("name", fmt::format("parameter '{}' is given twice", names.back()));
    }
  }
  const auto size = static_cast<Eigen::Index>(names.size());
  parameters.correlation = Eigen::MatrixXd::Identity(size, size);
  if (!owner.has("correlation")) {
    owner.raw("correlation");
    return parameters;
  }
  TomlReader reader = owner.table("correlation");
  const bool has_matrix = reader.raw("matrix") != nullptr;
  const bool has_pairs = reader.raw("pairs") != nullptr;
  reader.finish();
  if (has_matrix == has_pairs) reader.fail("matrix", "give either matrix or pairs");
  parameters.correlation = has_matrix ? read_matrix(reader, size) : read_pairs(reader, names);
  try {
    std::vector<Distribution> marginals;
    for (const StudyParameter& parameter : parameters.list) marginals.emplace_back(parameter.distribution);
    JointDistribution(std::move(marginals), parameters.correlation);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", reader.where(), error.what()));
  }
  return parameters;
}

}  // namespace mottle::study
