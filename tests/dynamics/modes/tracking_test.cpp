#include "mottle/dynamics/modes/tracking.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "mottle/dynamics/modes/mac.hpp"

namespace mottle::dynamics {
namespace {

TEST(TrackModes, FindsAPermutationOfTheReference) {
  const Eigen::MatrixXd reference = Eigen::MatrixXd::Identity(4, 3);
  Eigen::MatrixXd shapes(4, 4);
  shapes << 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0;
  const TrackedModes tracked = track_modes(shape_cosines(reference, shapes), 0.5);
  EXPECT_THAT(tracked.mode, ::testing::ElementsAre(2, 1, 3));
  EXPECT_THAT(tracked.mac, ::testing::ElementsAre(1.0, 1.0, 1.0));
}

// Shapes turned by an angle t have MAC cos(t)^2 with the reference; beyond 45 degrees the two change places.
TEST(TrackModes, ReportsTheMacOfTurnedShapes) {
  for (const double degrees : {10.0, 44.0, 46.0, 80.0}) {
    const double t = degrees * std::numbers::pi / 180.0;
    const Eigen::MatrixXd shapes =
        (Eigen::MatrixXd(2, 2) << std::cos(t), -std::sin(t), std::sin(t), std::cos(t)).finished();
    const TrackedModes tracked = track_modes(shape_cosines(Eigen::MatrixXd::Identity(2, 2), shapes), 0.5);
    EXPECT_EQ(tracked.mode[0], degrees < 45.0 ? 0 : 1) << degrees;
    EXPECT_NEAR(tracked.mac[0], std::max(std::pow(std::cos(t), 2), std::pow(std::sin(t), 2)), 1e-14) << degrees;
  }
}

TEST(TrackModes, NamesTheModesThatChangedTheirOrder) {
  const Eigen::MatrixXd cosines = Eigen::Vector3i(1, 0, 2).asPermutation().toDenseMatrix().cast<double>();
  const TrackedModes tracked = track_modes(cosines, 0.5);
  EXPECT_THAT(tracked.crossed, ::testing::ElementsAre(std::pair(0, 1)));
  EXPECT_TRUE(tracked.mixed.empty());
}

// Two shapes turned in their own plane by 45 degrees: each alone has MAC 1/2, together they span the same plane.
TEST(TrackModes, ShapesThatMixAreKeptTogetherByTheirSubspace) {
  const double c = std::sqrt(0.5) - 1e-9;
  Eigen::MatrixXd cosines = Eigen::MatrixXd::Identity(3, 4);
  cosines.topLeftCorner(2, 2) << c, -c, c, c;
  const TrackedModes tracked = track_modes(cosines, 0.6);
  EXPECT_THAT(tracked.mixed, ::testing::ElementsAre(std::vector<int>{0, 1}));
  EXPECT_NEAR(tracked.subspace_mac[0], 1.0, 1e-8);
  EXPECT_NEAR(tracked.subspace_mac[1], 1.0, 1e-8);
  EXPECT_EQ(tracked.subspace_mac[2], 1.0);
}

TEST(TrackModes, AModeThatLeftTheSubspaceIsNotSavedByOthers) {
  Eigen::MatrixXd cosines = Eigen::MatrixXd::Identity(3, 3);
  cosines(1, 1) = 0.3;
  const TrackedModes tracked = track_modes(cosines, 0.5);
  EXPECT_NEAR(tracked.subspace_mac[1], 0.09, 1e-12);
  EXPECT_TRUE(tracked.mixed.empty());
}

}  // namespace
}  // namespace mottle::dynamics
