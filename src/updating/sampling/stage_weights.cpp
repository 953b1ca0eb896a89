#include "updating/sampling/stage_weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mottle::updating {
namespace {

constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();

/// (sum w)^2 / sum w^2 of weights exp(increment log_likelihood), the largest of which is 1.
double effective_of(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood, double largest, double increment) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : log_likelihood) {
    if (value == k_minus_infinity) continue;
    const double weight = std::exp(increment * (value - largest));
    sum += weight;
    squares += weight * weight;
  }
  return sum * sum / squares;
}

double next_increment(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood, double exponent, double fraction) {
  constexpr int k_halvings = 100;
  const double largest = log_likelihood.maxCoeff();
  const auto alive = static_cast<double>((log_likelihood.array() > k_minus_infinity).count());
  const double wanted = fraction * alive;
  double high = 1.0 - exponent;
  if (effective_of(log_likelihood, largest, high) >= wanted) return high;
  double low = 0.0;
  for (int halving = 0; halving < k_halvings; ++halving) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    (effective_of(log_likelihood, largest, middle) >= wanted ? low : high) = middle;
  }
  return high;
}

}  // namespace

StageWeights next_stage(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood, double exponent, double fraction) {
  const double largest = log_likelihood.maxCoeff();
  const double increment = next_increment(log_likelihood, exponent, fraction);
  const Eigen::VectorXd weights =
      log_likelihood.unaryExpr([&](double value) { return std::exp(increment * (value - largest)); });
  return {.exponent = exponent + increment >= 1.0 ? 1.0 : exponent + increment,
          .weights = weights / weights.sum(),
          .log_mean = increment * largest + std::log(weights.mean()),
          .effective_samples = weights.sum() * weights.sum() / weights.squaredNorm()};
}

std::vector<Eigen::Index> systematic_parents(const Eigen::Ref<const Eigen::VectorXd>& weights, double shift) {
  std::vector<Eigen::Index> parents;
  Eigen::Index parent = 0;
  double sum = weights(0);
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const double place = (static_cast<double>(i) + shift) / static_cast<double>(weights.size());
    while (sum < place && parent + 1 < weights.size()) sum += weights(++parent);
    parents.push_back(parent);
  }
  return parents;
}

double correlation_limit(double decorrelation, int particles) {
  constexpr double k_by_chance = 2.5;
  return std::max(decorrelation, k_by_chance / std::sqrt(static_cast<double>(particles)));
}

double correlation_of(const Eigen::Ref<const Eigen::ArrayXd>& first, const Eigen::Ref<const Eigen::ArrayXd>& second) {
  const Eigen::ArrayXd a = first - first.mean();
  const Eigen::ArrayXd b = second - second.mean();
  const double scale = std::sqrt(a.square().sum() * b.square().sum());
  return scale > 0.0 ? (a * b).sum() / scale : 0.0;
}

}  // namespace mottle::updating
