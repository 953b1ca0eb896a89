#include "study/results/proposed_toml.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <utility>

#include "mottle/stats/distributions/default_transform.hpp"
#include "study/input/toml_writer.hpp"
#include "study/results/init_text.hpp"

namespace mottle::study {
namespace {

std::string number_text(double value) {
  return toml_on_one_line(toml::value<double>(value));
}

std::string distribution_text(const DistributionSpec& spec) {
  std::string text = fmt::format("kind = \"{}\"", distribution_kind_info(spec.kind).name);
  const std::pair<const char*, double> values[] = {
      {"mean", spec.mean}, {"std", spec.std}, {"lower", spec.lower}, {"upper", spec.upper}};
  for (const auto& [name, value] : values) {
    if (!std::isnan(value)) text += fmt::format(", {} = {}", name, number_text(value));
  }
  return text;
}

std::string parameter_text(StudyParameter parameter, bool is_random) {
  std::string text = "\n[[parameter]]\n";
  if (!is_random)
    text += "# One value for all specimens explains the tests: its standard deviation may come out as 0.\n";
  if (parameter.may_vanish) {  // a parameter needs a mean above 0
    text += "# It is 0 in the model: the mean is a guess.\n";
    parameter.distribution.mean = parameter.distribution.std;
  }
  toml::array targets;
  for (const std::string& target : parameter.targets) targets.push_back(target);
  text += fmt::format("name = {}\ntarget = {}\n{}distribution = {{ {} }}\n", toml_string(parameter.name),
                      targets.size() == 1 ? toml_string(parameter.targets.front()) : toml_on_one_line(targets),
                      parameter.is_factor ? "relative = true\n" : "", distribution_text(parameter.distribution));
  if (std::isfinite(parameter.lower_bound) || std::isfinite(parameter.upper_bound)) {
    text += fmt::format("bounds = [{}, {}]\n", number_text(parameter.lower_bound), number_text(parameter.upper_bound));
  }
  const ParameterTransform::Kind scale = parameter.transform.kind;
  // A logit between a prior's ends cannot be written as a scale: it would be between the bounds.
  if (scale == ParameterTransform::Kind::log || scale != default_transform(parameter.distribution).kind)
    text += fmt::format("scale = \"{}\"\n", scale_name(scale));
  return text;
}

}  // namespace

std::string proposed_toml(const DiagnoseOutcome& outcome) {
  std::string text;
  for (const ProposedParameter& proposed : outcome.diagnosis.proposed) {
    for (const StudyParameter& parameter : outcome.whole.parameters.list) {
      const bool is_new = !proposed.is_given && parameter.name == proposed.name;
      if (is_new) text += parameter_text(parameter, proposed.is_random);
    }
  }
  const auto more = static_cast<Eigen::Index>(outcome.diagnosis.proposed.size());
  if (!text.empty() && more > outcome.outputs) {
    text = "# With these there are more parameters than outputs: the tests cannot determine all of them.\n" + text;
  }
  if (!text.empty() && !outcome.study.diagnose.candidates.empty()) {
    text = "# Take these off [diagnose] candidates.\n" + text;
  }
  if (!text.empty() && !outcome.study.parameters.correlation.isIdentity(0.0)) {
    text = "# A matrix of [correlation] needs rows and columns for these parameters.\n" + text;
  }
  return text;
}

}  // namespace mottle::study
