#include "mottle/stats/moments/quantiles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mottle::stats {
namespace {

const std::vector<double> k_values{7.0, 1.0, 2.5, 11.0, 4.0};

// R 4.2: quantile(c(7, 1, 2.5, 11, 4), c(.1, .25, .5, .9, .99), type = 5, 6, 7).
TEST(Quantiles, AreThoseOfR) {
  struct Case {
    double probability, midpoints, expectation, ends;
  };
  for (const auto& [p, midpoints, expectation, ends] :
       {Case{0.1, 1.0, 1.0, 1.6}, Case{0.25, 2.125, 1.75, 2.5}, Case{0.5, 4.0, 4.0, 4.0}, Case{0.9, 11.0, 11.0, 9.4},
        Case{0.99, 11.0, 11.0, 10.84}}) {
    EXPECT_NEAR(quantile(k_values, p, QuantileRule::midpoints), midpoints, 1e-12) << p;
    EXPECT_NEAR(quantile(k_values, p, QuantileRule::expectation), expectation, 1e-12) << p;
    EXPECT_NEAR(quantile(k_values, p, QuantileRule::ends), ends, 1e-12) << p;
  }
}

TEST(Quantiles, EqualTailsTakeWhatIsNoNumberForInfinite) {
  const Eigen::RowVector2d ends = equal_tails(k_values, 0.5, QuantileRule::ends);
  EXPECT_EQ(ends, Eigen::RowVector2d(2.5, 7.0));
  const Eigen::RowVector2d open = equal_tails({1.0, NAN, 2.0}, 0.8, QuantileRule::ends);
  EXPECT_NEAR(open(0), 1.2, 1e-12);
  EXPECT_EQ(open(1), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace mottle::stats
