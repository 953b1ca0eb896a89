#include "updating/verdict/scatter_tests.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"

namespace mottle::updating {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Smallest x >= 1 with found(x), found monotone; infinite beyond gross.
double smallest(const std::function<bool(double)>& found) {
  constexpr double k_max = 1e8;
  double low = 1.0;
  double high = 2.0;
  while (!found(high)) {
    low = high;
    high *= 2.0;
    if (high > k_max) return k_infinity;
  }
  constexpr double k_close = 1e-3;
  while (high - low > k_close * low) {
    const double middle = 0.5 * (low + high);
    (found(middle) ? high : low) = middle;
  }
  return high;
}

/// What variance ratio in one whitened direction means for the outputs.
Power output_power(double ratio, const ResidualLeverage& residuals) {
  const Eigen::ArrayXd extra = (ratio - 1.0) / residuals.leverage.array().max(1e-300);
  const Eigen::ArrayXd factor = (1.0 + extra / residuals.variance.array().max(1e-300)).sqrt();
  Eigen::Index least = 0;
  Eigen::Index most = 0;
  const double best = factor.minCoeff(&least);
  const double worst = factor.maxCoeff(&most);
  const auto name = [&](Eigen::Index k) { return residuals.names[static_cast<std::size_t>(k)]; };
  const auto times = [](double value) {
    return value > 100.0 ? std::string("more than 100") : fmt::format("{:.3g}", value);
  };
  return {fmt::format("an output that scatters by itself {} ({}) to {} ({}) times as much as the model says",
                      times(best), name(least), times(worst), name(most)),
          best <= k_gross_error};
}

}  // namespace

std::vector<std::string> output_names(const UpdatingProblem& problem) {
  std::vector<std::string> names;
  for (const Quantity& output : problem.model.outputs()) names.push_back(output.name());
  return names;
}

PlannedTest residual_scatter_test(double squares, double specimens, double directions,
                                  const ResidualLeverage& leverage) {
  const double degrees_of_freedom = specimens * directions;
  PlannedTest test = chi_squared_test("scatter-of-residuals", squares, degrees_of_freedom);
  test.aspect = Aspect::scatter;
  test.meaning = fmt::format(
      "Chi-squared with {:.0f} degrees of freedom: do the residuals scatter from specimen to specimen no more than the "
      "measurement's noise?",
      degrees_of_freedom);
  test.too_small = fmt::format(
      "The residuals scatter less than the stated noise allows (chi-squared {:.2g} with {:.0f} degrees of freedom): "
      "the "
      "noise of the tests seems to be stated too large, so that the tests of the model find less than they say.",
      squares, degrees_of_freedom);
  // ratio chi2(specimens) + chi2(the rest), by the chi-squared variable with the same mean and variance.
  test.power = [=](double level) {
    const double critical = chi_squared_quantile(1.0 - level, degrees_of_freedom);
    return output_power(smallest([&](double ratio) {
                          const double mean = degrees_of_freedom - specimens + ratio * specimens;
                          const double spread = degrees_of_freedom - specimens + ratio * ratio * specimens;
                          return chi_squared_upper_tail(critical * mean / spread, mean * mean / spread) >=
                                 1.0 - k_missed;
                        }),
                        leverage);
  };
  return test;
}

Eigen::VectorXi counts_with_scatter(const TestMoments& tests) {
  const Eigen::ArrayXd digits = (k_last_digits * tests.mean.array()).square();
  return (tests.covariance.diagonal().array() > digits).select(tests.count, 0);
}

}  // namespace mottle::updating
