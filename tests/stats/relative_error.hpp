// Comparison of doubles by relative error, for references that other programs printed in full.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

namespace mottle::stats {

/// Passes where |actual - expected| <= tolerance |expected|.
inline ::testing::AssertionResult is_relatively_near(double actual, double expected, double tolerance) {
  if (std::abs(actual - expected) <= tolerance * std::abs(expected)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << ::testing::PrintToString(actual) << " instead of "
                                       << ::testing::PrintToString(expected) << ", relative error "
                                       << (actual - expected) / expected;
}

}  // namespace mottle::stats
