// Median and robust deviation.
#include "mottle/stats/moments/robust.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

TEST(Robust, MedianIsOfTheFiniteValues) {
  EXPECT_EQ(median(Eigen::Vector3d(5.0, 1.0, 3.0)), 3.0);
  EXPECT_EQ(median(Eigen::Vector4d(7.0, 1.0, 3.0, k_nan)), 3.0);
  EXPECT_EQ(median(Eigen::Vector4d(7.0, 1.0, 3.0, 4.0)), 3.5);
  EXPECT_TRUE(std::isnan(median(Eigen::Vector2d::Constant(k_nan))));
}

TEST(Robust, DeviationIsThatOfANormalSampleWhateverFewValuesAre) {
  constexpr Eigen::Index k_count = 2001;
  Eigen::VectorXd values(k_count);
  for (Eigen::Index i = 0; i < k_count; ++i)
    values(i) = 4.0 + 0.5 * standard_normal_quantile((static_cast<double>(i) + 0.5) / k_count);
  EXPECT_NEAR(robust_deviation(values), 0.5, 1e-3);
  values.tail(20).setConstant(1e9);
  EXPECT_NEAR(robust_deviation(values), 0.5, 0.01);
  values(0) = k_nan;
  EXPECT_NEAR(robust_deviation(values), 0.5, 0.01);
}

}  // namespace
}  // namespace mottle::stats
