#include "updating/verdict/test_plan.hpp"

#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/non_central_f.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"

namespace mottle::updating {
namespace {

std::string capitalised(Aspect aspect) {
  return aspect == Aspect::means ? "The means" : "The scatter";
}

}  // namespace

void TestPlan::make(double level, UpdatingResult& result) const {
  constexpr double k_too_good = 0.999;
  double shares = 0.0;
  for (const PlannedTest& test : tests_) shares += test.share;
  std::set<Aspect> tested{Aspect::none};
  std::map<Aspect, std::vector<std::string>> sentences = untested_;
  for (const PlannedTest& planned : tests_) {
    const double own = -std::expm1(std::log1p(-level) * planned.share / shares);
    VerdictTest test{.name = planned.name,
                     .statistic = planned.statistic,
                     .critical = planned.critical(own),
                     .p_value = planned.p_value,
                     .meaning = planned.meaning};
    test.passed = test.statistic <= test.critical;
    if (planned.power) {
      const Power power = planned.power(own);
      test.meaning += fmt::format(" With 80 % probability it would find {}.", power.finds);
      if (power.is_enough) tested.insert(planned.aspect);
      sentences[planned.aspect].push_back(
          fmt::format("{} were hardly tested: with 80 % probability only {} would have been found. Test more "
                      "specimens, or give [test] repeatability.",
                      capitalised(planned.aspect), power.finds));
    }
    if (!planned.too_small.empty() && test.p_value > k_too_good) result.warnings.push_back(planned.too_small);
    if (!test.passed || planned.is_listed_where_it_passes) result.tests.push_back(std::move(test));
  }
  for (const auto& [aspect, reasons] : sentences) {
    if (tested.contains(aspect)) continue;
    result.lacks_outputs = result.lacks_outputs || lacking_.contains(aspect);
    result.not_tested.insert(result.not_tested.end(), reasons.begin(), reasons.end());
  }
}

PlannedTest chi_squared_test(std::string name, double statistic, double degrees_of_freedom) {
  return {.name = std::move(name),
          .statistic = statistic,
          .p_value = chi_squared_upper_tail(std::max(statistic, 0.0), degrees_of_freedom),
          .critical = [=](double level) { return chi_squared_quantile(1.0 - level, degrees_of_freedom); },
          .meaning = {}};
}

PlannedTest f_test(std::string name, double statistic, double numerator, double denominator) {
  const boost::math::fisher_f law(numerator, denominator);
  return {.name = std::move(name),
          .statistic = statistic,
          .p_value = boost::math::cdf(complement(law, std::max(statistic, 0.0))),
          .critical = [=](double level) { return boost::math::quantile(complement(law, level)); },
          .meaning = {}};
}

double chi_squared_detectable(double degrees_of_freedom, double level) {
  return boost::math::non_central_chi_squared::find_non_centrality(
      degrees_of_freedom, chi_squared_quantile(1.0 - level, degrees_of_freedom), k_missed);
}

double f_detectable(double numerator, double denominator, double level) {
  constexpr double k_max = 1e5;  // far beyond gross errors
  const double critical = boost::math::quantile(complement(boost::math::fisher_f(numerator, denominator), level));
  const auto missed = [&](double noncentrality) {
    return boost::math::cdf(boost::math::non_central_f(numerator, denominator, noncentrality), critical);
  };
  double low = chi_squared_detectable(numerator, level) * 0.5;
  double high = low;
  while (missed(high) > k_missed) {
    low = high;
    high *= 2.0;
    if (high > k_max) return std::numeric_limits<double>::infinity();
  }
  constexpr double k_close = 1e-3;
  while (high - low > k_close * high) {
    const double middle = 0.5 * (low + high);
    (missed(middle) > k_missed ? low : high) = middle;
  }
  return high;
}

std::string directions_text(double count) {
  return count == 1.0 ? "the one direction" : fmt::format("the {:.0f} directions", count);
}

}  // namespace mottle::updating
