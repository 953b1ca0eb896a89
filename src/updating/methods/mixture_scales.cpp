#include "updating/methods/mixture_scales.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "updating/population/population_prior.hpp"
#include "updating/verdict/normality_report.hpp"

namespace mottle::updating {
namespace {

/// Free numbers of a batch: its weight, its mean, its covariance.
double numbers_of_a_batch(const PopulationFit& one) {
  const auto q = static_cast<double>(one.map.cols());
  const std::vector<int>& groups = one.settings.covariance_groups;
  double covariances = 0.0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) covariances += groups[i] == groups[j] ? 1.0 : 0.0;
  }
  return 1.0 + q + (groups.empty() ? 0.5 * q * (q + 1.0) : covariances);
}

/// ln of how much more probable the batches make the tests than one population does, less the penalty of BIC.
double penalised_gain(const PopulationFit& one, const MixtureNumber& number, Eigen::Index specimens) {
  double gain = 0.0;
  for (const ComponentsTest& test : number.tests) {
    if (test.is_refused)
      gain += 0.5 * (test.statistic - numbers_of_a_batch(one) * std::log(static_cast<double>(specimens)));
  }
  return gain;
}

std::optional<PopulationFit> fit_on_scales(const UpdatingProblem& problem, PopulationFitSettings settings,
                                           const RunContext& context, std::int64_t& evaluations) {
  settings.start.resize(0);  // on the study's scales
  settings.first.resize(0);
  try {
    PopulationFit fit = fit_population(problem, problem.tests.values, settings, context,
                                       [&](const PopulationFit&) { return !context.stop_requested(); });
    evaluations += fit.evaluations;
    context.throw_if_stopped();
    return fit;
  } catch (const ModelFailure&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<ExplainingScales> explaining_scales(
    const UpdatingProblem& problem, const SolvedPopulation& solved, const MixtureNumber& number,
    const RunContext& context, const std::function<MixtureNumber(const UpdatingProblem&, const PopulationFit&)>& choose,
    std::int64_t& evaluations) {
  constexpr double k_ten_times = 2.302585;
  const bool is_split = std::ranges::any_of(number.tests, &ComponentsTest::is_refused);
  if (number.is_given || !is_split) return std::nullopt;
  const PopulationFit& one = solved.best();
  const std::vector<std::optional<ParameterTransform>> others = more_normal_scales(problem, one);
  std::vector<Parameter> parameters = problem.space.parameters();
  ExplainingScales found;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!others[i]) continue;
    parameters[i].transform = *others[i];
    found.names.push_back(parameters[i].name);
    found.scales.push_back(*others[i]);
  }
  if (found.names.empty()) return std::nullopt;
  const ParameterSpace space(std::move(parameters), problem.space.prior());
  const UpdatingProblem other{problem.model, problem.derivatives, space,
                              problem.tests, problem.cloud,       problem.iterations,
                              problem.level, problem.tolerance,   problem.covariance_groups,
                              problem.starts};
  const std::optional<PopulationFit> fit = fit_on_scales(other, solved.settings, context, evaluations);
  if (!fit) return std::nullopt;
  const double gain = plain_log_likelihood(*fit) - plain_log_likelihood(one);
  if (!(gain >= k_ten_times) || !(gain >= penalised_gain(one, number, problem.tests.values.rows())))
    return std::nullopt;
  const MixtureNumber there = choose(other, *fit);
  if (there.tests.empty() || there.tests.front().is_refused) return std::nullopt;
  found.p_value = there.tests.front().p_value;
  return found;
}

std::string explaining_scales_note(const ExplainingScales& found, const MixtureNumber& number) {
  std::vector<std::string> scales;
  for (std::size_t i = 0; i < found.names.size(); ++i) {
    scales.push_back(fmt::format("scale = \"{}\" of {}", scale_name(found.scales[i].kind), found.names[i]));
  }
  const auto batches = 1 + std::ranges::count_if(number.tests, &ComponentsTest::is_refused);
  return fmt::format(
      "The specimens look like {} batches (p = {:.2g} for one), but one skewed population explains them as well: with "
      "{} they are normal, and two batches are not seen there (p = {:.2g}). No batches are reported. Set that scale.",
      batches, number.tests.front().p_value, join(scales), found.p_value);
}

}  // namespace mottle::updating
