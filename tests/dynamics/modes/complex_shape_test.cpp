#include "mottle/dynamics/modes/complex_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace mottle::dynamics {
namespace {

TEST(NearestRealShape, TurnsARealShapeOfAnyPhaseBack) {
  const Eigen::Vector3d shape(1.0, -0.5, 0.25);
  for (const double phase : {0.0, 0.4, 1.5, 3.0, -2.0}) {
    const RealShape real = nearest_real_shape(shape * std::polar(1.0, phase));
    EXPECT_NEAR(real.collinearity, 1.0, 1e-14);
    const double sign = real.shape(0) < 0.0 ? -1.0 : 1.0;
    EXPECT_TRUE((sign * real.shape).isApprox(shape, 1e-14)) << phase;
  }
}

// Components (a, ib): Sxx = a^2, Syy = b^2, Sxy = 0, so MPC = ((a^2 - b^2) / (a^2 + b^2))^2.
TEST(NearestRealShape, TellsHowFarThePhasesScatter) {
  Eigen::Vector2cd shape;
  shape << 2.0, std::complex<double>(0.0, 1.0);
  EXPECT_NEAR(nearest_real_shape(shape).collinearity, 9.0 / 25.0, 1e-15);
  shape << 1.0, std::complex<double>(0.0, 1.0);
  EXPECT_NEAR(nearest_real_shape(shape).collinearity, 0.0, 1e-15);
}

TEST(NearestRealShape, LeavesAZeroShape) {
  EXPECT_EQ(nearest_real_shape(Eigen::Vector2cd::Zero()).shape, Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace mottle::dynamics
