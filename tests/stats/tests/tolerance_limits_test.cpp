#include "mottle/stats/tests/tolerance_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

// By adaptive quadrature over SciPy's chi2 and ncx2; to two digits behind the point also ISO 16269-6, table of exact
// two-sided factors.
TEST(NormalToleranceFactor, IsThatOfAnotherQuadrature) {
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(2, 0.95, 0.95), 36.519214612060544, 1e-6));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(3, 0.95, 0.95), 9.788752403021013, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(5, 0.95, 0.95), 5.076874532061071, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(10, 0.95, 0.95), 3.3934294787126067, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(30, 0.95, 0.95), 2.5548928132782445, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(100, 0.95, 0.95), 2.233882023066558, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(10, 0.99, 0.9), 3.957961910580119, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(5, 0.9, 0.99), 6.654929690632794, 1e-7));
  EXPECT_TRUE(is_relatively_near(normal_tolerance_factor(7, 0.999, 0.999), 13.799782266914942, 1e-6));
}

TEST(NormalToleranceFactor, FallsTowardsTheQuantileOfTheNormal) {
  EXPECT_LT(normal_tolerance_factor(1000000, 0.95, 0.95), 1.963);
  EXPECT_GT(normal_tolerance_factor(1000000, 0.95, 0.95), 1.95996);
}

TEST(NormalToleranceFactor, HasItsConfidence) {
  constexpr int k_replications = 20000;
  for (const int n : {5, 10}) {
    const double k = normal_tolerance_factor(n, 0.95, 0.95);
    int covered = 0;
    for (int replication = 0; replication < k_replications; ++replication) {
      RandomStream stream({.seed = 7, .purpose = StreamPurpose::truth, .iteration = static_cast<std::uint32_t>(n)},
                          static_cast<std::uint32_t>(replication));
      double sum = 0.0, squares = 0.0;
      for (int s = 0; s < n; ++s) {
        const double z = standard_normal_quantile(stream.uniform());
        sum += z;
        squares += z * z;
      }
      const double mean = sum / n;
      const double std = std::sqrt((squares - n * mean * mean) / (n - 1));
      const double content = standard_normal_cdf(mean + k * std) - standard_normal_cdf(mean - k * std);
      covered += content >= 0.95 ? 1 : 0;
    }
    // Four binomial standard errors of a confidence of 0.95.
    EXPECT_NEAR(covered / static_cast<double>(k_replications), 0.95, 4.0 * std::sqrt(0.95 * 0.05 / k_replications));
  }
}

TEST(Extremes, NeedTheNumbersThatArePrintedEverywhere) {  // two-sided limits by first and last: [Wilks1941] and tables
  EXPECT_EQ(specimens_for_extremes(0.95, 0.95), 93);
  EXPECT_EQ(specimens_for_extremes(0.9, 0.9), 38);
  EXPECT_EQ(specimens_for_extremes(0.99, 0.95), 473);
  EXPECT_EQ(specimens_for_extremes(0.5, 0.95), 8);
}

TEST(Extremes, ContainWhatTheirConfidenceSays) {
  EXPECT_GE(confidence_of_extremes(93, 0.95), 0.95);
  EXPECT_LT(confidence_of_extremes(92, 0.95), 0.95);
  const double content = content_of_extremes(30, 0.95);
  EXPECT_NEAR(confidence_of_extremes(30, content), 0.95, 1e-12);
  EXPECT_NEAR(content, 0.8514039313, 1e-9);  // SciPy: beta.ppf(0.05, 29, 2)
}

TEST(ToleranceLimits, RefuseWhatHasNone) {
  EXPECT_THROW(normal_tolerance_factor(1, 0.95, 0.95), InvalidInput);
  EXPECT_THROW(normal_tolerance_factor(5, 1.0, 0.95), InvalidInput);
  EXPECT_THROW(specimens_for_extremes(0.95, 1.0), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
