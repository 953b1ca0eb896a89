#include "mottle/stats/population/normal_intervals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

TEST(NormalIntervals, MeanAndDeviationAreThoseOfTheTables) {
  // t(0.975, 9) = 2.262157163; chi-squared(9): 2.700389500 and 19.022767799 (Abramowitz and Stegun, 26.8, 26.10).
  const Interval mean = mean_interval(2.0, 0.3, 10, 0.95);
  EXPECT_NEAR(mean.upper - 2.0, 2.262157163 * 0.3 / std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(mean.lower + mean.upper, 4.0, 1e-14);
  const Interval standard_deviation = standard_deviation_interval(0.3, 10, 0.95);
  EXPECT_NEAR(standard_deviation.lower, 0.3 * std::sqrt(9.0 / 19.022767799), 1e-9);
  EXPECT_NEAR(standard_deviation.upper, 0.3 * std::sqrt(9.0 / 2.700389500), 1e-9);
}

TEST(NormalIntervals, CorrelationInvertsHotellingsDensityOfTheSampleCorrelation) {
  // Ends rho with P(r <= observed | rho) = 0.975 and 0.025, the density of r by its hypergeometric series (Hotelling
  // 1953) integrated with Simpson's rule in a program of its own.
  struct Case {
    double r;
    int n;
    double lower, upper;
  };
  for (const Case& c :
       {Case{0.5, 10, -0.18091568381383905, 0.8392889193976085}, Case{-0.8, 6, -0.9643001476856232, 0.0286767110517554},
        Case{0.3, 50, 0.022992057309341153, 0.5297570992647023},
        Case{0.95, 20, 0.8702557185850535, 0.9790022996604375}}) {
    const Interval interval = correlation_interval(c.r, c.n, 0.95);
    EXPECT_NEAR(interval.lower, c.lower, 1e-9);
    EXPECT_NEAR(interval.upper, c.upper, 1e-9);
  }
}

TEST(NormalIntervals, CorrelationBarelySignificantReachesZero) {
  // r sqrt(n - 2) / sqrt(1 - r^2) = t(0.975, 8) = 2.306004135: the test of no correlation is Student's.
  const double r = 2.306004135 / std::sqrt(8.0 + 2.306004135 * 2.306004135);
  EXPECT_NEAR(correlation_interval(r, 10, 0.95).lower, 0.0, 1e-8);
}

TEST(NormalIntervals, CorrelationIsOddAndAtItsEndsKnown) {
  const Interval above = correlation_interval(0.4, 7, 0.95);
  const Interval below = correlation_interval(-0.4, 7, 0.95);
  EXPECT_NEAR(above.lower, -below.upper, 1e-12);
  EXPECT_NEAR(above.upper, -below.lower, 1e-12);
  EXPECT_EQ(correlation_interval(0.7, 2, 0.95).lower, -1.0);
  EXPECT_EQ(correlation_interval(1.0, 5, 0.95).lower, 1.0);
  EXPECT_LT(correlation_interval(0.1, 3, 0.95).lower, -0.9);
}

TEST(NormalIntervals, RefuseImpossibleSamples) {
  EXPECT_THROW(mean_interval(0.0, 1.0, 1, 0.95), InvalidInput);
  EXPECT_THROW(standard_deviation_interval(-1.0, 5, 0.95), InvalidInput);
  EXPECT_THROW(correlation_interval(1.1, 5, 0.95), InvalidInput);
  EXPECT_THROW(correlation_interval(0.1, 5, 1.0), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
