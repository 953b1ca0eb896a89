#include "study/proposal/explanatory_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mottle::study {
namespace {

constexpr int k_sweeps = 3;

/// The candidate of the largest gain with its preference, of those whose gain without it exceeds `least`; -1: none.
Eigen::Index best_addition(const LinearExplanation& explanation, const LinearisedTests& problem, double least,
                           LinearExplanation::Gain& best) {
  Eigen::Index found = -1;
  for (Eigen::Index j = 0; j < problem.changes.cols(); ++j) {
    if (explanation.has(j)) continue;
    const LinearExplanation::Gain gain = explanation.gain(j);
    if (gain.value - problem.preferences(j) < least) continue;
    if (found < 0 || gain.value > best.value) {
      best = gain;
      found = j;
    }
  }
  return found;
}

void add_forward(LinearExplanation& explanation, const LinearisedTests& problem, std::size_t most) {
  while (explanation.chosen().size() < most) {
    LinearExplanation::Gain gain;
    const Eigen::Index next = best_addition(explanation, problem, least_gain(problem.changes.cols()), gain);
    if (next < 0) break;
    explanation.add(next, gain.variance);
    explanation.estimate(k_sweeps);
  }
}

/// Whether an exchange of one of the chosen for another number was found that raises the likelihood.
bool exchange_one(LinearExplanation& explanation, const LinearisedTests& problem) {
  constexpr double k_least = 0.1;
  for (const Eigen::Index number : std::vector<Eigen::Index>(explanation.chosen())) {
    LinearExplanation without = explanation;
    without.remove(number);
    LinearExplanation::Gain gain;
    const Eigen::Index other = best_addition(without, problem, least_gain(problem.changes.cols()), gain);
    if (other < 0 || other == number) continue;
    without.add(other, gain.variance);
    without.estimate(k_sweeps);
    if (without.value() < explanation.value() + k_least) continue;
    explanation = without;
    return true;
  }
  return false;
}

double loss_without(const LinearExplanation& explanation, Eigen::Index number) {
  LinearExplanation without = explanation;
  without.remove(number);
  without.estimate(k_sweeps);
  return explanation.value() - without.value();
}

/// Whether one was removed: the one that is missed least, if that is little.
bool remove_one(LinearExplanation& explanation, const LinearisedTests& problem) {
  Eigen::Index least = -1;
  double smallest = least_gain(problem.changes.cols());
  for (const Eigen::Index number : explanation.chosen()) {
    const double loss = loss_without(explanation, number) - problem.preferences(number);
    if (loss >= smallest) continue;
    smallest = loss;
    least = number;
  }
  if (least < 0) return false;
  explanation.remove(least);
  explanation.estimate(k_sweeps);
  return true;
}

ExplanatoryNumbers describe(const LinearExplanation& explanation, const LinearisedTests& problem) {
  ExplanatoryNumbers found{.mean = explanation.expected_mean(), .noise = explanation.noise()};
  std::vector<std::pair<double, Eigen::Index>> order;
  for (const Eigen::Index number : explanation.chosen()) {
    order.emplace_back(loss_without(explanation, number) - problem.preferences(number), number);
  }
  std::ranges::stable_sort(order, [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [loss, number] : order) {
    found.chosen.push_back(number);
    found.losses.push_back(loss);
  }
  found.gains = Eigen::VectorXd::Zero(problem.changes.cols());
  for (Eigen::Index j = 0; j < problem.changes.cols(); ++j) {
    if (!explanation.has(j)) found.gains(j) = explanation.gain(j).value - problem.preferences(j);
  }
  return found;
}

}  // namespace

double least_gain(Eigen::Index candidates) {
  return 1.0 + std::log(static_cast<double>(std::max<Eigen::Index>(candidates, 3)));
}

ExplanatoryNumbers select_explanatory(const LinearisedTests& problem, std::size_t most,
                                      const std::vector<Eigen::Index>& chosen, bool is_fixed) {
  constexpr int k_rounds = 5;
  constexpr int k_exchanges = 20;
  constexpr int k_final_sweeps = 10;
  LinearExplanation explanation(problem);
  for (const Eigen::Index number : chosen) explanation.add(number, explanation.gain(number).variance);
  explanation.estimate(k_sweeps);
  for (int round = 0; round < k_rounds && !is_fixed; ++round) {
    add_forward(explanation, problem, most);
    int exchanges = 0;
    while (exchanges < k_exchanges && exchange_one(explanation, problem)) ++exchanges;
    int removed = 0;
    while (remove_one(explanation, problem)) ++removed;
    if (removed == 0) break;
  }
  explanation.estimate(k_final_sweeps);
  return describe(explanation, problem);
}

}  // namespace mottle::study
