#include "mottle/stats/moments/robust.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "mottle/stats/moments/quantiles.hpp"

namespace mottle::stats {

double median(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::vector<double> known;
  for (const double value : values) {
    if (std::isfinite(value)) known.push_back(value);
  }
  if (known.empty()) return std::numeric_limits<double>::quiet_NaN();
  return quantile(std::move(known), 0.5, QuantileRule::ends);
}

double robust_deviation(const Eigen::Ref<const Eigen::VectorXd>& values) {
  constexpr double k_of_normal = 1.4826;
  return k_of_normal * median((values.array() - median(values)).abs().matrix());
}

}  // namespace mottle::stats
