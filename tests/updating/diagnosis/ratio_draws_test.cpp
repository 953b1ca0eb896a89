#include "updating/diagnosis/ratio_draws.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"

namespace mottle::updating {
namespace {

/// Likelihood ratios of one parameter that is not missing, in large samples.
std::vector<double> chi_squared_draws(int count, std::uint32_t replication) {
  const StreamKey key{.seed = 5, .purpose = StreamPurpose::bootstrap, .iteration = replication};
  RandomStream stream(key, 0);
  std::vector<double> draws;
  for (int i = 0; i < count; ++i) draws.push_back(chi_squared_quantile(stream.uniform(), 1.0));
  return draws;
}

TEST(RatioDraws, TheProbabilityWithinTheDrawsIsTheirFrequency) {
  std::vector<double> draws;
  for (int i = 1; i <= 100; ++i) draws.push_back(i);
  EXPECT_DOUBLE_EQ(RatioDraws(draws).upper_tail(50.5), 51.0 / 101.0);  // 50 beyond, the observed one counted
}

TEST(RatioDraws, TheTailIsTheExponentialOfTheMeanExcess) {
  std::vector<double> draws;
  for (int i = 1; i <= 100; ++i) draws.push_back(i);
  // x90 = 90, excesses 1 to 10, mean 5.5
  EXPECT_NEAR(RatioDraws(draws).upper_tail(145.0), 0.1 * std::exp(-10.0), 1e-15);
}

TEST(RatioDraws, AFarRatioIsDecidedByAHundredDraws) {
  EXPECT_TRUE(RatioDraws(chi_squared_draws(100, 1)).decide(200.0, 0.05 / 90.0, 0.05));
}

TEST(RatioDraws, ARatioThatMayBeEitherIsNot) {
  const double observed = chi_squared_quantile(0.99, 1.0);  // p = 0.01, between the levels
  for (std::uint32_t r = 0; r < 200; ++r) {
    EXPECT_FALSE(RatioDraws(chi_squared_draws(100, r)).decide(observed, 0.05 / 90.0, 0.05));
  }
}

TEST(RatioDraws, WhatIsJustNotSignificantIsHardlyEverDecidedToBeSo) {
  // True p on the border: to be called smaller by draws in one of 1,000 cases, were the tail exactly exponential. That
  // of chi-squared is lighter, which errs to the other side.
  const double least = 0.05 / 90.0;
  const double observed = chi_squared_quantile(1.0 - least, 1.0);
  int decided = 0;
  for (std::uint32_t r = 0; r < 4000; ++r) {
    decided += RatioDraws(chi_squared_draws(100, r)).decide(observed, least, 0.05) ? 1 : 0;
  }
  EXPECT_LE(decided, 12);  // four and two standard deviations more
}

TEST(RatioDraws, WhatIsJustSignificantIsHardlyEverDecidedNotToBe) {
  const double observed = chi_squared_quantile(0.95, 1.0);
  int decided = 0;
  for (std::uint32_t r = 0; r < 4000; ++r) {
    decided += RatioDraws(chi_squared_draws(100, r)).decide(observed, 1e-4, 0.05) ? 1 : 0;
  }
  EXPECT_LE(decided, 12);
}

}  // namespace
}  // namespace mottle::updating
