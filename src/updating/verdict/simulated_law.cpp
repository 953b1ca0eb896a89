#include "updating/verdict/simulated_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::updating {
namespace {

constexpr double k_least_level = 1e-12;  // quantiles beyond would be infinite

}  // namespace

void judge_by_studies(const StudiedStatistic& statistic, const std::function<double(double)>& tail, PlannedTest& test) {
  constexpr double k_surely_small = 0.999;
  std::vector<double> ordered(statistic.simulated.begin(), statistic.simulated.end());
  std::ranges::sort(ordered);
  const auto studies = static_cast<double>(ordered.size());
  const auto beyond = std::ranges::count_if(ordered, [&](double value) { return value >= statistic.observed; });
  if (test.p_value <= k_surely_small) test.too_small.clear();
  test.statistic = statistic.observed;
  test.p_value = (1.0 + static_cast<double>(beyond)) / (studies + 1.0);
  test.critical = [ordered, studies](double level) {
    constexpr double k_rounding = 1e-9;
    const double place = std::ceil((1.0 - level) * (studies + 1.0) - k_rounding);
    if (place > studies) return std::numeric_limits<double>::infinity();
    return ordered[static_cast<std::size_t>(std::max(place, 1.0)) - 1];
  };
  if (test.power) {
    test.power = [of_closed_form = test.power, critical = test.critical, tail](double level) {
      return of_closed_form(std::clamp(tail(critical(level)), k_least_level, level));
    };
  }
  test.meaning += fmt::format(" Compared with {:.0f} studies simulated at the estimate.", studies);
}

}  // namespace mottle::updating
