#include "updating/verdict/cloud_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

/// p-value of a ratio of variances whose tails have these probabilities.
double p_value(double above, double below, bool is_whole) {
  return std::min(is_whole ? 2.0 * std::min(above, below) : below, 1.0);
}

double normal_p_value(const ScatterComparison& c, Eigen::Index k) {
  const double degrees_of_freedom = c.count(k) - 1;
  const double above = chi_squared_upper_tail(degrees_of_freedom * c.tested(k) / c.model(k), degrees_of_freedom);
  return p_value(above, 1.0 - above, c.is_whole[static_cast<std::size_t>(k)]);
}

/// Draws of one output of the updated model, in its standard deviations: a sample of the cloud, and the noise.
class DrawnOutput {
 public:
  DrawnOutput(const ScatterComparison& c, Eigen::Index k) : samples_(c.cloud.col(k)) {
    samples_.array() -= samples_.mean();
    const double variance = samples_.squaredNorm() / static_cast<double>(samples_.size() - 1);
    const double share = std::min(variance / c.model(k), 1.0);
    samples_ *= std::sqrt(share / std::max(variance, 1e-300));
    noise_ = std::sqrt(1.0 - share);
  }

  /// Sample variance of some specimens.
  double variance(int specimens, RandomStream& stream) const {
    double sum = 0.0;
    double squares = 0.0;
    const auto size = static_cast<double>(samples_.size());
    for (int s = 0; s < specimens; ++s) {
      double value = samples_(static_cast<Eigen::Index>(stream.uniform() * size));
      if (noise_ > 0.0) value += noise_ * standard_normal_quantile(stream.uniform());
      sum += value;
      squares += value * value;
    }
    return (squares - sum * sum / specimens) / (specimens - 1);
  }

 private:
  Eigen::VectorXd samples_;
  double noise_ = 0.0;
};

/// Enough for the level of one output of all.
int draws_for(const ScatterComparison& c) {
  constexpr int k_fewest = 20000;
  constexpr int k_of_an_output = 2000;
  return std::max(k_fewest, k_of_an_output * static_cast<int>(c.tested.size()));
}

/// The same by simulation; more specimens than a thousand, which know a variance well, count as that many.
double simulated_p_value(const ScatterComparison& c, Eigen::Index k) {
  const int draws = draws_for(c);
  constexpr int k_most_specimens = 1000;
  const int specimens = std::min(c.count(k), k_most_specimens);
  const DrawnOutput output(c, k);
  const double ratio = c.tested(k) / c.model(k);
  int above = 1;  // the tests themselves
  int below = 1;
  for (int r = 0; r < draws; ++r) {
    RandomStream stream({.seed = 3, .purpose = StreamPurpose::bootstrap, .iteration = static_cast<std::uint32_t>(k)},
                        static_cast<std::uint32_t>(r));
    const double drawn = output.variance(specimens, stream);
    above += drawn >= ratio ? 1 : 0;
    below += drawn <= ratio ? 1 : 0;
  }
  const auto probability = [&](int count) { return static_cast<double>(count) / (draws + 1.0); };
  return p_value(probability(above), probability(below), c.is_whole[static_cast<std::size_t>(k)]);
}

struct Unlikeliest {
  double p_value = 1.0;
  Eigen::Index output = 0;
};

/// In the order of what chi-squared says, until the rest cannot be more unlikely: the least p-value is that of tests
/// beyond all draws.
Unlikeliest unlikeliest_output(const ScatterComparison& c) {
  constexpr double k_unlikely = 0.2;  // the level of a quarter of a share is lower
  Eigen::VectorXd p = Eigen::VectorXd::Ones(c.tested.size());
  for (Eigen::Index k = 0; k < p.size(); ++k) {
    if (c.count(k) >= 2 && c.model(k) > 0.0) p(k) = normal_p_value(c, k);
  }
  std::vector<Eigen::Index> order(static_cast<std::size_t>(p.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](Eigen::Index k) { return p(k); });
  Unlikeliest found{1.0, order.front()};
  for (const Eigen::Index k : order) {
    if (p(k) >= found.p_value || found.p_value <= 2.0 / (draws_for(c) + 1.0)) break;
    const bool is_drawn = p(k) < k_unlikely && c.cloud.rows() > 1;
    const double own = is_drawn ? std::max(p(k), simulated_p_value(c, k)) : p(k);
    if (own < found.p_value) found = {own, k};
  }
  return found;
}

}  // namespace

PlannedTest cloud_agreement_test(const ScatterComparison& comparison) {
  const Unlikeliest found = unlikeliest_output(comparison);
  const auto outputs = static_cast<double>(comparison.tested.size());
  const auto as_normal = [](double p) {
    constexpr double k_min = 1e-15;  // quantiles of the normal distribution beyond would be infinite
    return -standard_normal_quantile(0.5 * std::max(p, k_min));
  };
  return {.name = "scatter-agreement",
          .statistic = std::max(as_normal(found.p_value), 0.0),
          .p_value = -std::expm1(outputs * std::log1p(-std::min(found.p_value, 1.0 - 1e-16))),
          .critical = [=](double level) { return as_normal(-std::expm1(std::log1p(-level) / outputs)); },
          .meaning = fmt::format(
              "Variances of {} outputs: does the updated model's cloud have the scatter of the tests? The standard "
              "deviation of {} differs most, {:.3g} times that of the tests (in standard normal deviates).",
              comparison.tested.size(), comparison.names[static_cast<std::size_t>(found.output)],
              std::sqrt(comparison.model(found.output) / comparison.tested(found.output))),
          .share = 0.25,
          .is_listed_where_it_passes = false};
}

}  // namespace mottle::updating
