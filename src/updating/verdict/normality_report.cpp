#include "updating/verdict/normality_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/text.hpp"

namespace mottle::updating {
namespace {

constexpr double k_passes = 0.05;  // p-value from which another explanation is good enough

/// Values that are numbers, and the specimens they are of.
struct Estimates {
  std::vector<double> values;
  std::vector<Eigen::Index> specimens;

  double p_value() const {
    const auto size = static_cast<Eigen::Index>(values.size());
    constexpr Eigen::Index k_min = 5;
    if (size < k_min) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::Map<const Eigen::VectorXd> all(values.data(), size);
    return normality_probabilities(normality_statistics(all), size).p_value;
  }
};

/// A parameter's estimates on its scale, their scatter that of the population.
Estimates estimates_of(const VariableNormality& variable, double mean, const std::vector<Outlier>& left_out) {
  Estimates estimates;
  for (Eigen::Index s = 0; s < variable.scores.size(); ++s) {
    const bool is_out = std::any_of(left_out.begin(), left_out.end(), [&](const Outlier& o) { return o.sample == s; });
    if (is_out || std::isnan(variable.scores(s))) continue;
    estimates.values.push_back(mean + variable.scores(s));
    estimates.specimens.push_back(s);
  }
  return estimates;
}

constexpr double k_clearly = 10.0;  // times as probable as on the present scale

/// The scale other than the parameter's own on which its estimates look normal best; nothing where none is good enough.
/// @param factor  by which its p-value must exceed that on the present scale
std::optional<ParameterTransform> better_scale(const Parameter& parameter, const Estimates& on_scale, double p_value,
                                               double factor = k_clearly) {
  std::vector<ParameterTransform> others{{.kind = ParameterTransform::Kind::identity},
                                         {.kind = ParameterTransform::Kind::log}};
  if (std::isfinite(parameter.lower_bound) && std::isfinite(parameter.upper_bound)) {
    others.push_back({ParameterTransform::Kind::logit, parameter.lower_bound, parameter.upper_bound});
  }
  std::optional<ParameterTransform> best;
  double best_p = std::max(k_passes, factor * p_value);
  for (const ParameterTransform& other : others) {
    if (other.kind == parameter.transform.kind) continue;
    Estimates turned = on_scale;
    bool is_possible = true;
    for (double& value : turned.values) {
      value = parameter.transform.to_variable(value);
      is_possible = is_possible && (other.kind != ParameterTransform::Kind::log || value > 0.0) &&
                    (other.kind != ParameterTransform::Kind::logit || (value > other.lower && value < other.upper));
      if (is_possible) value = other.from_variable(value);
    }
    if (!is_possible || !(turned.p_value() > best_p)) continue;
    best = other;
    best_p = turned.p_value();
  }
  return best;
}

/// Centres, sizes and members of the two batches.
std::string batches_text(const Parameter& parameter, const Estimates& estimates, Eigen::Index below,
                         const TestData& tests) {
  std::vector<std::size_t> order(estimates.values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return estimates.values[a] < estimates.values[b]; });
  const auto split = order.begin() + static_cast<std::ptrdiff_t>(below);
  const auto centre = [&](auto begin, auto end) {
    double sum = 0.0;
    for (auto i = begin; i != end; ++i) sum += estimates.values[*i];
    return parameter.transform.to_variable(sum / static_cast<double>(end - begin));
  };
  std::vector<int> members;
  for (auto i = split; i != order.end(); ++i) members.push_back(tests.number_of(estimates.specimens[*i]));
  std::sort(members.begin(), members.end());
  constexpr std::size_t k_listed = 12;
  std::vector<std::string> names;
  for (const int member : members) names.push_back(fmt::format("{}", member));
  const bool is_long = names.size() > k_listed;
  if (is_long) names.resize(k_listed);
  return fmt::format("two batches, {} specimens around {:.4g} and {} around {:.4g} (specimens {}{})", below,
                     centre(order.begin(), split), members.size(), centre(split, order.end()), join(names),
                     is_long ? ", ..." : "");
}

/// What the estimates of one parameter look like.
std::string suggestion_for(const Parameter& parameter, const VariableNormality& variable, double mean,
                           const std::vector<Outlier>& outliers, const TestData& tests) {
  const Estimates estimates = estimates_of(variable, mean, {});
  constexpr std::size_t k_most = 5;  // a fifth: more than these are no outliers, but a batch
  const bool are_few = k_most * outliers.size() <= estimates.values.size();
  const bool is_but_for_outliers =
      !outliers.empty() && are_few && estimates_of(variable, mean, outliers).p_value() > k_passes;
  if (const auto scale = better_scale(parameter, estimates, variable.probabilities.p_value)) {
    return fmt::format(
        "{} looks normal on the scale \"{}\": set scale = \"{}\"{}", parameter.name, scale_name(scale->kind),
        scale_name(scale->kind),
        is_but_for_outliers ? ", or check the specimens named as outliers, without which it is normal" : "");
  }
  if (is_but_for_outliers) {
    return fmt::format("{} is normal except for the specimens named as outliers", parameter.name);
  }
  if (variable.probabilities.two_batches <= k_passes) {
    return fmt::format("{} looks like {}: update each by itself", parameter.name,
                       batches_text(parameter, estimates, variable.statistics.lower_batch, tests));
  }
  return fmt::format("{} is not normal", parameter.name);
}

}  // namespace

std::vector<std::optional<ParameterTransform>> more_normal_scales(const UpdatingProblem& problem,
                                                                  const PopulationFit& fit) {
  constexpr double k_twice = 2.0;  // where scales hardly differ over the specimens their p-values do not
  std::vector<std::optional<ParameterTransform>> scales(problem.space.parameters().size());
  const NormalityTest test = test_normality(fit.units, fit.effects, fit.map);
  for (std::size_t i = 0; i < test.variables.size(); ++i) {
    const VariableNormality& variable = test.variables[i];
    if (!variable.is_tested) continue;
    const Estimates estimates = estimates_of(variable, fit.mean(static_cast<Eigen::Index>(i)), {});
    scales[i] = better_scale(problem.space.parameters()[i], estimates, variable.probabilities.p_value, k_twice);
  }
  return scales;
}

void report_normality(const UpdatingProblem& problem, const PopulationFit& fit, UpdatingResult& result) {
  constexpr double k_mostly_noise = 0.5;
  const NormalityTest test = test_normality(fit.units, fit.effects, fit.map);
  if (test.tests == 0) return;
  NormalityReport report{.test = test,
                         .level = problem.level,
                         .is_remarkable = test.p_value <= problem.level,
                         .suggestions = std::vector<std::string>(test.variables.size())};
  std::vector<std::string> hardly_tested;
  std::vector<std::string> remarks;
  for (std::size_t i = 0; i < test.variables.size(); ++i) {
    const VariableNormality& variable = test.variables[i];
    const Parameter& parameter = problem.space.parameters()[i];
    if (!variable.is_tested) continue;
    if (variable.reliability < k_mostly_noise) hardly_tested.push_back(parameter.name);
    if (variable.probabilities.p_value > test.level_of_each(problem.level)) continue;
    report.suggestions[i] =
        suggestion_for(parameter, variable, fit.mean(static_cast<Eigen::Index>(i)), result.outliers, problem.tests);
    remarks.push_back(fmt::format("{} (p = {:.2g})", report.suggestions[i], variable.probabilities.p_value));
  }
  if (report.is_remarkable && remarks.empty()) {
    remarks.push_back(
        fmt::format("each parameter by itself may be normal, all together are not (p = {:.2g})", test.henze_zirkler_p));
  }
  if (report.is_remarkable) {
    result.notes.push_back(fmt::format(
        "Remark, not evidence against the model: the specimens do not look like a normal population, which means, "
        "standard deviations and intervals assume. {}.",
        join(remarks, "; ")));
  }
  if (!hardly_tested.empty()) {
    result.notes.push_back(
        fmt::format("Whether the population is normal could hardly be tested for {}: noise or missing entries "
                    "dominate the estimates of the specimens.",
                    join(hardly_tested)));
  }
  result.normality = std::move(report);
}

}  // namespace mottle::updating
