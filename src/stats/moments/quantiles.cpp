#include "mottle/stats/moments/quantiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mottle::stats {
namespace {

/// Counted from 0, between which of the sorted values.
double place_of(double probability, double count, QuantileRule rule) {
  switch (rule) {
    case QuantileRule::midpoints:
      return probability * count - 0.5;
    case QuantileRule::expectation:
      return probability * (count + 1.0) - 1.0;
    case QuantileRule::ends:
      break;
  }
  return probability * (count - 1.0);
}

}  // namespace

double sorted_quantile(std::span<const double> sorted, double probability, QuantileRule rule) {
  const auto count = static_cast<double>(sorted.size());
  const double place = std::clamp(place_of(probability, count, rule), 0.0, count - 1.0);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  if (!std::isfinite(sorted[above])) return sorted[above];
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double quantile(std::vector<double> values, double probability, QuantileRule rule) {
  std::sort(values.begin(), values.end());
  return sorted_quantile(values, probability, rule);
}

Eigen::RowVector2d equal_tails(std::vector<double> values, double confidence, QuantileRule rule) {
  for (double& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  std::sort(values.begin(), values.end());
  return {sorted_quantile(values, 0.5 * (1.0 - confidence), rule),
          sorted_quantile(values, 0.5 * (1.0 + confidence), rule)};
}

}  // namespace mottle::stats
