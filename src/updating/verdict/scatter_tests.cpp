#include "updating/verdict/scatter_tests.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

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

/// What of a Wishart matrix W John's statistic needs when its first direction is stretched.
struct DrawnScatter {
  double own;     // W_11
  double shared;  // sum of W_1j^2, j > 1
  double trace;   // of the rest
  double square;  // tr of the rest squared

  /// U where the variance of the first direction is `ratio` times that of the others.
  double sphericity(double ratio, double directions) const {
    const double sum = ratio * own + trace;
    return directions * (ratio * ratio * own * own + 2.0 * ratio * shared + square) / (sum * sum) - 1.0;
  }
};

/// Wishart matrices of d directions with nu degrees of freedom: by Bartlett's triangular factor, or by nu samples where
/// these are fewer.
std::vector<DrawnScatter> draw_scatters(Eigen::Index d, double degrees_of_freedom) {
  constexpr std::uint32_t k_draws = 400;  // a power of 80 % to 2 %
  const auto columns = std::min(d, static_cast<Eigen::Index>(std::ceil(degrees_of_freedom)));
  std::vector<DrawnScatter> draws;
  for (std::uint32_t r = 0; r < k_draws; ++r) {
    RandomStream stream({.seed = 2, .purpose = StreamPurpose::bootstrap}, r);
    Eigen::MatrixXd root = Eigen::MatrixXd::Zero(d, columns);
    for (Eigen::Index j = 0; j < columns; ++j) {
      for (Eigen::Index i = columns < d ? 0 : j; i < d; ++i) root(i, j) = standard_normal_quantile(stream.uniform());
      if (columns < d) continue;
      const boost::math::chi_squared law(degrees_of_freedom - static_cast<double>(j));
      root(j, j) = std::sqrt(boost::math::quantile(law, stream.uniform()));
    }
    const Eigen::MatrixXd wishart = root * root.transpose();
    const auto rest = wishart.bottomRightCorner(d - 1, d - 1);
    draws.push_back({wishart(0, 0), wishart.col(0).tail(d - 1).squaredNorm(), rest.trace(), rest.squaredNorm()});
  }
  return draws;
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

PlannedTest sphericity_test(const Eigen::Ref<const Eigen::MatrixXd>& scatter, double specimens,
                            const ResidualLeverage& leverage) {
  const auto d = static_cast<double>(scatter.rows());
  const double mean = scatter.trace() / d;
  const double u = scatter.squaredNorm() / (mean * mean * d) - 1.0;
  const double degrees_of_freedom = 0.5 * d * (d + 1.0) - 1.0;
  // Mean of U for a Wishart matrix: E tr W^2 / E (tr W)^2, tr W being independent of W / tr W.
  const double expected = d * (specimens + d + 1.0) / (specimens * d + 2.0) - 1.0;
  const double scale = degrees_of_freedom / expected;
  PlannedTest test = chi_squared_test("scatter-of-residuals", scale * u, degrees_of_freedom);
  test.aspect = Aspect::scatter;
  test.meaning = fmt::format(
      "John's test of sphericity with {:.0f} degrees of freedom: do the residuals scatter alike in the {:.0f} "
      "directions that no parameter moves, as measurement noise does?",
      degrees_of_freedom, d);
  test.power = [=](double level) {
    const double needed = chi_squared_quantile(1.0 - level, degrees_of_freedom) / scale;
    const std::vector<DrawnScatter> draws = draw_scatters(static_cast<Eigen::Index>(d), specimens);
    return output_power(smallest([&](double ratio) {
                          const auto found = std::count_if(draws.begin(), draws.end(), [&](const DrawnScatter& draw) {
                            return draw.sphericity(ratio, d) > needed;
                          });
                          return static_cast<double>(found) >= (1.0 - k_missed) * static_cast<double>(draws.size());
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
