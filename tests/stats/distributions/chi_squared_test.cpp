#include "mottle/stats/distributions/chi_squared.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/error.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

// SciPy 1.10: chi2.ppf(.95, 3), chi2.ppf(.99, 10).
TEST(ChiSquared, QuantilesAreThoseOfScipy) {
  EXPECT_TRUE(is_relatively_near(chi_squared_quantile(0.95, 3.0), 7.814727903251179, 1e-12));
  EXPECT_TRUE(is_relatively_near(chi_squared_quantile(0.99, 10.0), 23.209251158954356, 1e-12));
}

// SciPy 1.10: chi2.sf(30, 4), chi2.sf(1, 2.5).
TEST(ChiSquared, UpperTailsAreThoseOfScipy) {
  EXPECT_TRUE(is_relatively_near(chi_squared_upper_tail(30.0, 4.0), 4.894437128029217e-06, 1e-12));
  EXPECT_TRUE(is_relatively_near(chi_squared_upper_tail(1.0, 2.5), 0.7162100473346871, 1e-12));
  EXPECT_EQ(chi_squared_upper_tail(0.0, 2.0), 1.0);
  EXPECT_EQ(chi_squared_upper_tail(INFINITY, 2.0), 0.0);
}

TEST(ChiSquared, RefusesArgumentsOutsideTheirRange) {
  EXPECT_THROW(static_cast<void>(chi_squared_quantile(1.0, 2.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(chi_squared_quantile(0.5, 0.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(chi_squared_upper_tail(-1.0, 2.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(chi_squared_upper_tail(NAN, 2.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(chi_squared_upper_tail(1.0, NAN)), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
