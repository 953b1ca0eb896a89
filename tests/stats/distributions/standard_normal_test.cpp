#include "mottle/stats/distributions/standard_normal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/error.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

// SciPy 1.10: [repr(scipy.special.ndtri(p)) for p in (1e-300, 1e-16, .025, .3)].
TEST(StandardNormal, QuantilesAreThoseOfScipyDownToTheSmallestProbability) {
  EXPECT_TRUE(is_relatively_near(standard_normal_quantile(1e-300), -37.0470962993612, 1e-14));
  EXPECT_TRUE(is_relatively_near(standard_normal_quantile(1e-16), -8.222082216130435, 1e-14));
  EXPECT_TRUE(is_relatively_near(standard_normal_quantile(0.025), -1.9599639845400545, 1e-14));
  EXPECT_TRUE(is_relatively_near(standard_normal_quantile(0.3), -0.5244005127080409, 1e-14));
}

TEST(StandardNormal, QuantileIsOddAboutOneHalf) {
  EXPECT_EQ(standard_normal_quantile(0.5), 0.0);
  EXPECT_EQ(standard_normal_quantile(0.75), -standard_normal_quantile(0.25));
}

TEST(StandardNormal, CdfUndoesTheQuantile) {
  for (const double p : {1e-200, 1e-16, 0.01, 0.5, 0.99}) {
    // The condition of the cdf is z phi / Phi, about z^2 = 900 far out in the tail.
    EXPECT_TRUE(is_relatively_near(standard_normal_cdf(standard_normal_quantile(p)), p, 1e-12));
  }
}

TEST(StandardNormal, EndsAreInfiniteAndTheRestIsRefused) {
  EXPECT_EQ(standard_normal_quantile(0.0), -INFINITY);
  EXPECT_EQ(standard_normal_quantile(1.0), INFINITY);
  EXPECT_THROW(static_cast<void>(standard_normal_quantile(-1e-9)), InvalidInput);
  EXPECT_THROW(static_cast<void>(standard_normal_quantile(NAN)), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
