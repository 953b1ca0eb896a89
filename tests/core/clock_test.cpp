#include "mottle/core/clock.hpp"

#include <gtest/gtest.h>

namespace mottle {
namespace {

TEST(DurationText, HasTheUnitThatItIsReadIn) {
  EXPECT_EQ(duration_text(0.18), "0.18 s");
  EXPECT_EQ(duration_text(1.2), "1 s");
  EXPECT_EQ(duration_text(119.0), "119 s");
  EXPECT_EQ(duration_text(120.0), "2 min");
  EXPECT_EQ(duration_text(7199.0), "120 min");
  EXPECT_EQ(duration_text(9000.0), "2.5 h");
}

TEST(SteadySeconds, NeverGoBack) {
  const double before = steady_seconds();
  EXPECT_GE(steady_seconds(), before);
}

}  // namespace
}  // namespace mottle
