#include "study/results/method_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mottle/core/text.hpp"
#include "mottle/updating/estimate/mixture_population.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/abc.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "study/input/first_few.hpp"

namespace mottle::study {
namespace {

/// "specimen 4", "specimens 1 to 9, 12", "23 specimens" where their list is long. Expects ascending numbers.
std::string specimens_text(const std::vector<int>& numbers) {
  std::vector<std::string> runs;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (last < first + 2) last = first;
    runs.push_back(last == first ? fmt::format("{}", numbers[first])
                                 : fmt::format("{} to {}", numbers[first], numbers[last]));
    first = last + 1;
  }
  constexpr std::size_t k_most_runs = 8;
  if (runs.size() > k_most_runs) return fmt::format("{} specimens", numbers.size());
  return fmt::format("specimen{} {}", numbers.size() == 1 ? "" : "s", join(runs));
}

// Batches

std::string number_of_batches(const MixtureFindings& found) {
  const std::size_t count = found.batches.size();
  const std::string what = count == 1 ? "one batch" : fmt::format("{} batches", count);
  if (found.is_number_given) return fmt::format("The specimens were divided into {}, as the study asks.", what);
  if (count == 1) {
    std::string text = "The specimens are one batch";
    if (!found.tests.empty()) text += fmt::format(": a second one is not shown (p = {:.2g})", found.tests[0].p_value);
    if (found.detectable)
      text += fmt::format("; one {:.2g} standard deviations away would be in 80 % of cases", *found.detectable);
    return text + '.';
  }
  std::string text = "The specimens come from " + what;
  for (const ComponentsTest& test : found.tests) {
    if (test.components + 1 == static_cast<int>(count) && test.is_refused)
      text += fmt::format("; {} refused (p = {:.2g})",
                          test.components == 1 ? "one batch is" : fmt::format("{} batches are", test.components),
                          test.p_value);
  }
  return text + '.';
}

std::string members_of_batches(const TestData& tests, const MixtureFindings& found) {
  constexpr double k_clear = 0.9;  // below it the next probable batch is worth a look
  std::vector<std::vector<int>> members(found.batches.size());
  std::vector<std::string> doubtful;
  for (Eigen::Index s = 0; s < found.probabilities.rows(); ++s) {
    const Eigen::Index batch = found.batch_of(s);
    if (batch < 0) continue;
    members[static_cast<std::size_t>(batch)].push_back(tests.number_of(s));
    if (found.probabilities(s, batch) < k_clear)
      doubtful.push_back(fmt::format("{} ({:.0f} %)", tests.number_of(s), 100.0 * found.probabilities(s, batch)));
  }
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (!members[k].empty()) parts.push_back(fmt::format("batch {}: {}", k + 1, specimens_text(members[k])));
  }
  std::string text = join(parts, "; ");
  if (!text.empty()) text = " B" + text.substr(1) + '.';
  if (!doubtful.empty()) text += fmt::format(" Doubtful: {}.", first_few(doubtful));
  return text;
}

/// The parameter whose means differ most between two batches, in their standard deviations.
std::string difference_of_batches(const UpdatingProblem& problem, const std::vector<Batch>& batches) {
  double largest = 0.0;
  Eigen::Index apart = -1;
  for (std::size_t k = 1; k < batches.size(); ++k) {
    for (std::size_t j = 0; j < k; ++j) {
      for (Eigen::Index i = 0; i < batches[k].mean.size(); ++i) {
        const double spread = std::hypot(batches[k].std(i), batches[j].std(i));
        const double distance =
            std::abs(batches[k].mean(i) - batches[j].mean(i)) / std::max(spread, std::numeric_limits<double>::min());
        if (!(distance > largest)) continue;
        largest = distance;
        apart = i;
      }
    }
  }
  if (apart < 0) return {};
  const Parameter& parameter = problem.space.parameters()[static_cast<std::size_t>(apart)];
  std::vector<std::string> means;
  for (const Batch& batch : batches) means.push_back(fmt::format("{:.4g}", batch.mean(apart)));
  const std::string unit = parameter.unit.empty() || parameter.unit == "-" ? "" : ' ' + parameter.unit;
  return fmt::format(" They differ most in {}: means {}{}.", parameter.name, join(means, " and "), unit);
}

std::string answer_of(const UpdatingProblem& problem, const MixtureFindings& found) {
  std::string text = number_of_batches(found);
  if (found.batches.size() > 1) {
    text += members_of_batches(problem.tests, found) + difference_of_batches(problem, found.batches);
  }
  return text;
}

// A box

std::string answer_of(const UpdatingProblem& problem, const IntervalResult& interval) {
  std::vector<std::string> left;
  for (std::size_t k = 0; k < interval.image.size(); ++k) {
    if (interval.excess.row(static_cast<Eigen::Index>(k)).minCoeff() < 0.0)
      left.push_back(problem.model.outputs()[k].name());
  }
  std::string text = left.empty()
                         ? fmt::format("The box covers the bounds of all {} outputs.", interval.image.size())
                         : fmt::format("The box covers the bounds of {} of {} outputs, and not those of {}.",
                                       interval.image.size() - left.size(), interval.image.size(), first_few(left));
  return text + (interval.outside.empty() ? " It holds the parameters that fit each specimen by itself."
                                          : fmt::format(" The parameters that fit {} alone lie outside it.",
                                                        specimens_text(interval.outside)));
}

// Simulations and chains

constexpr double k_max_r_hat = 1.01;  // [Vehtari2021]

std::string answer_of(const AbcFindings& found) {
  if (found.stages.empty()) return {};
  const AbcStage& last = found.stages.back();
  std::string text = fmt::format(
      "{} of {} simulated sets of tests were accepted ({:.2g} %), at a tolerance of {:.3g} standard deviations.",
      last.accepted, last.simulations,
      100.0 * static_cast<double>(last.accepted) / static_cast<double>(last.simulations), last.tolerance);
  if (std::isfinite(found.exceeded)) {
    text += fmt::format(
        " Tests simulated from the estimate lie at least as far from its cloud as these in {:.2g} % of cases.",
        100.0 * found.exceeded);
  }
  return text;
}

/// The pair of parameters that the posterior ties together, where it does.
std::string strongest_correlation(const UpdatingProblem& problem, const UpdatingResult& result) {
  constexpr double k_strong = 0.9;  // a combination is known at least 4 times as well as its partner
  if (result.is_population) return {};
  double largest = k_strong;
  std::string text;
  for (Eigen::Index i = 0; i < result.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double correlation = result.covariance(i, j) / std::sqrt(result.covariance(i, i) * result.covariance(j, j));
      if (!(std::abs(correlation) >= largest)) continue;
      largest = std::abs(correlation);
      text = fmt::format(
          " {} and {} are correlated by {:.3f}: the tests determine a combination of them better than either.",
          problem.space.names()[static_cast<std::size_t>(j)], problem.space.names()[static_cast<std::size_t>(i)],
          correlation);
    }
  }
  return text;
}

std::string answer_of(const UpdatingProblem& problem, const UpdatingResult& result, const SampledPosterior& posterior) {
  if (posterior.r_hat.size() == 0 || posterior.ess_bulk.size() == 0) return {};
  Eigen::Index worst = 0;
  const double r_hat = posterior.r_hat.maxCoeff(&worst);
  const std::string size = fmt::format("{} chains of {} draws are worth {:.0f} independent draws at least",
                                       posterior.chains, posterior.draws, posterior.ess_bulk.minCoeff());
  if (result.status == UpdatingStatus::converged)
    return fmt::format("The chains mixed: R-hat is at most {:.4f}, and {}.", r_hat, size) +
           strongest_correlation(problem, result);
  const std::string beginning = result.status == UpdatingStatus::max_iterations
                                    ? "The chains did not reach the posterior"
                                : r_hat > k_max_r_hat ? "The chains did not mix"
                                                      : "The chains agree, but the sampling is in doubt";
  const auto at = static_cast<std::size_t>(worst);
  return fmt::format("{}: R-hat of {} is {:.4f}, and {}.", beginning,
                     at < posterior.names.size() ? posterior.names[at] : "the log-likelihood", r_hat, size);
}

}  // namespace

std::string method_answer(const UpdatingProblem& problem, const UpdatingResult& result) {
  if (result.mixture && !result.mixture->batches.empty()) return answer_of(problem, *result.mixture);
  if (result.interval) return answer_of(problem, *result.interval);
  if (result.abc) return answer_of(*result.abc);
  if (result.posterior) return answer_of(problem, result, *result.posterior);
  return {};
}

}  // namespace mottle::study
