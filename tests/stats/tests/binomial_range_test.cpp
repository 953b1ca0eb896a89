#include "mottle/stats/tests/binomial_range.hpp"

#include <gtest/gtest.h>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

TEST(BinomialRange, IsThatOfTheQuantiles) {
  const CountRange ten = binomial_range(10, 0.5, 0.95);  // P(K <= 1) = 11/1024, P(K <= 2) = 56/1024, and mirrored
  EXPECT_EQ(ten.min_successes, 2);
  EXPECT_EQ(ten.max_successes, 8);
  const CountRange three = binomial_range(3, 0.1, 0.95);  // P(K <= 1) = 0.972, P(K <= 2) = 0.999
  EXPECT_EQ(three.min_successes, 0);
  EXPECT_EQ(three.max_successes, 2);
}

TEST(BinomialRange, IsEmptyWithoutTrials) {
  EXPECT_EQ(binomial_range(0, 0.5, 0.95).max_successes, 0);
}

TEST(BinomialRange, RefusesCertainty) {
  EXPECT_THROW(binomial_range(3, 1.0, 0.95), InvalidInput);
  EXPECT_THROW(binomial_range(-1, 0.5, 0.95), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
