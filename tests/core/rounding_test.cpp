#include "mottle/core/rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mottle {
namespace {

TEST(Rounding, KeepsSixDigitsOfTheRange) {
  EXPECT_EQ(digits_of_range(1.0, 1.0), 6);
  EXPECT_EQ(digits_of_range(1e-3, 1.0), 9);  // three digits are the same in all values
  EXPECT_EQ(rounded(1.0 / 3.0, 6), 0.333333);
}

TEST(Rounding, KeepsAllDigitsOfValuesWithoutARange) {
  EXPECT_EQ(rounded(1.0 / 3.0, digits_of_range(0.0, 1.0)), 1.0 / 3.0);
}

TEST(Rounding, LeavesWhatIsNotFinite) {
  EXPECT_TRUE(std::isnan(rounded(std::nan(""), 6)));
  EXPECT_TRUE(std::isinf(rounded(INFINITY, 6)));
}

}  // namespace
}  // namespace mottle
