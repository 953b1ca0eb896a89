#include "mottle/dynamics/modes/mode_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mottle::dynamics {
namespace {

TEST(NaturalFrequency, IsTheRootOverTwoPi) {
  EXPECT_DOUBLE_EQ(natural_frequency_hz(4.0, 4.0), 1.0 / std::numbers::pi);
  EXPECT_EQ(natural_frequency_hz(0.0, 4.0), 0.0);
}

// The documented border: -1e-7 of the scale.
TEST(NaturalFrequency, IsZeroWhereTheEigenvalueIsNegativeByRounding) {
  EXPECT_EQ(natural_frequency_hz(-0.99e-7 * 1e6, 1e6), 0.0);
}

TEST(NaturalFrequency, IsNotANumberForAnUnstableStructure) {
  EXPECT_TRUE(std::isnan(natural_frequency_hz(-1.01e-7 * 1e6, 1e6)));
  EXPECT_TRUE(std::isnan(natural_frequency_hz(-1.0, 1.0)));
}

TEST(NaturalFrequency, IsNotANumberWhereTheEigenvalueIsNone) {
  EXPECT_TRUE(std::isnan(natural_frequency_hz(std::numeric_limits<double>::quiet_NaN(), 1.0)));
}

TEST(NaturalFrequencies, TakeTheLargestEigenvalueForTheScale) {
  const Eigen::VectorXd frequencies = natural_frequencies_hz(Eigen::Vector4d(-1.0, -1e-4, 4.0, 1e6));
  EXPECT_TRUE(std::isnan(frequencies(0)));
  EXPECT_EQ(frequencies(1), 0.0);
  EXPECT_DOUBLE_EQ(frequencies(2), 1.0 / std::numbers::pi);
  EXPECT_EQ(natural_frequencies_hz(Eigen::VectorXd()).size(), 0);
}

}  // namespace
}  // namespace mottle::dynamics
