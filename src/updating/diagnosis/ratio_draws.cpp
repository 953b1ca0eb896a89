#include "updating/diagnosis/ratio_draws.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

constexpr double k_tail = 0.1;  // of 400 draws 40 excesses: their mean is known to 16 %
constexpr double k_doubt = 1e-3;

}  // namespace

RatioDraws::RatioDraws(std::vector<double> draws) : draws_(std::move(draws)) {
  std::sort(draws_.begin(), draws_.end());
  excesses_ = static_cast<std::size_t>(k_tail * count());
  const double sum = std::accumulate(draws_.end() - static_cast<std::ptrdiff_t>(excesses_), draws_.end(), 0.0);
  mean_excess_ = std::max(sum / static_cast<double>(excesses_) - border(), 1e-12);
}

double RatioDraws::beyond(double observed) const {
  return static_cast<double>(draws_.end() - std::lower_bound(draws_.begin(), draws_.end(), observed));
}

double RatioDraws::upper_tail(double observed) const {
  if (observed <= border()) return (1.0 + beyond(observed)) / (1.0 + count());
  return k_tail * std::exp(-(observed - border()) / mean_excess_);
}

bool RatioDraws::decide(double observed, double least, double most) const {
  if (observed <= border()) {
    const double p = beyond(observed) / count();
    return p - standard_normal_quantile(1.0 - k_doubt) * std::sqrt(p * (1.0 - p) / count()) > most;
  }
  const double twice = 2.0 * static_cast<double>(excesses_);
  const double largest_mean = mean_excess_ * twice / chi_squared_quantile(k_doubt, twice);
  return k_tail * std::exp(-std::max(observed - draws_.back(), 0.0) / largest_mean) < least;
}

}  // namespace mottle::updating
