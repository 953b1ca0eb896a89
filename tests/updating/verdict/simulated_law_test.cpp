#include "updating/verdict/simulated_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

PlannedTest judged(double observed, const Eigen::VectorXd& simulated) {
  PlannedTest test = chi_squared_test("a", 0.0, 1.0);
  judge_by_studies({observed, simulated}, {}, test);
  return test;
}

TEST(SimulatedLaw, CountsTheStudiesThatReachTheStatistic) {
  const Eigen::VectorXd studies = Eigen::VectorXd::LinSpaced(19, 1.0, 19.0);
  EXPECT_DOUBLE_EQ(judged(19.0, studies).p_value, 2.0 / 20.0);
  EXPECT_DOUBLE_EQ(judged(19.5, studies).p_value, 1.0 / 20.0);
  EXPECT_DOUBLE_EQ(judged(0.0, studies).p_value, 1.0);
}

TEST(SimulatedLaw, RefusesNothingAtALevelBelowWhatItsStudiesCanShow) {
  const Eigen::VectorXd studies = Eigen::VectorXd::LinSpaced(19, 1.0, 19.0);
  EXPECT_DOUBLE_EQ(judged(1e9, studies).critical(0.05), 19.0);
  EXPECT_EQ(judged(1e9, studies).critical(0.04), std::numeric_limits<double>::infinity());
}

/// Statistic and studies from one law: the probability to be beyond order statistic k of B is 1 - k / (B + 1).
TEST(SimulatedLaw, HasItsLevelWhateverTheLawOfTheStatistic) {
  constexpr int k_repetitions = 4000;
  constexpr Eigen::Index k_studies = 39;
  int refused = 0;
  for (int r = 0; r < k_repetitions; ++r) {
    RandomStream stream({.seed = 4, .purpose = StreamPurpose::truth}, static_cast<std::uint32_t>(r));
    const auto draw = [&] { return std::exp(2.0 * standard_normal_quantile(stream.uniform())); };
    const double observed = draw();
    const PlannedTest test =
        judged(observed, Eigen::VectorXd::NullaryExpr(k_studies, [&](Eigen::Index) { return draw(); }));
    refused += test.statistic > test.critical(0.05) ? 1 : 0;
  }
  // 200 expected, standard deviation 13.8
  EXPECT_NEAR(refused, 200, 3.0 * 13.8);
}

}  // namespace
}  // namespace mottle::updating
