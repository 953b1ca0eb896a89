// Shapes of close modes that have turned within what they span together.
#include "mottle/dynamics/modes/close_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mottle::dynamics {
namespace {

/// Three sine shapes at eight components, which are not orthogonal there.
Eigen::MatrixXd sines() {
  Eigen::MatrixXd shapes(8, 3);
  for (Eigen::Index k = 0; k < 8; ++k) {
    for (Eigen::Index m = 0; m < 3; ++m)
      shapes(k, m) = std::sin(0.3 * static_cast<double>((k + 1) * (m + 1)) + 0.1 * static_cast<double>(m));
  }
  return shapes;
}

/// The first two turned into one another.
Eigen::MatrixXd turned(double angle) {
  Eigen::MatrixXd shapes = sines();
  shapes.leftCols(2) *=
      (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
  return shapes;
}

const std::map<int, Eigen::Index> k_pairs = {{0, 0}, {1, 1}, {2, 2}};

CloseModes found(const Eigen::MatrixXd& measured, const Eigen::Vector3d& reference = {40.0, 42.0, 90.0},
                 const Eigen::Vector3d& tested = {41.0, 43.0, 88.0}) {
  const Eigen::MatrixXd shapes = sines();
  const Eigen::VectorXd model = reference;
  const Eigen::VectorXd tests = tested;
  return close_modes(0, k_pairs, {shapes, model}, {measured, tests});
}

TEST(CloseModes, SpanTogetherWhatTheyAreMixedFrom) {
  const CloseModes close = found(turned(0.9));
  EXPECT_THAT(close.modes, testing::ElementsAre(0, 1));
  EXPECT_NEAR(close.mac, 1.0, 1e-12);
}

TEST(CloseModes, HaveTheAngleOfTheirPlanes) {
  // Orthogonal shapes, the second tilted out of the plane by 0.4: MAC of the plane is cos^2 0.4.
  Eigen::MatrixXd reference = Eigen::MatrixXd::Identity(6, 3);
  Eigen::MatrixXd measured = reference;
  measured.col(1) = std::cos(0.4) * reference.col(1) + std::sin(0.4) * Eigen::VectorXd::Unit(6, 5);
  const Eigen::VectorXd frequencies = Eigen::Vector3d(40.0, 42.0, 90.0);
  for (const auto& shapes : {&reference, &measured}) shapes->row(3).setConstant(1e-9);
  for (const auto& shapes : {&reference, &measured}) shapes->row(4).setConstant(1e-9);
  for (const auto& shapes : {&reference, &measured}) shapes->row(5).array() += 1e-9;
  EXPECT_NEAR(close_modes(0, k_pairs, {reference, frequencies}, {measured, frequencies}).mac,
              std::pow(std::cos(0.4), 2), 1e-8);
}

TEST(CloseModes, AreNoneFarApartInFrequency) {
  EXPECT_THAT(found(turned(0.9), {40.0, 45.0, 90.0}).modes, testing::IsEmpty());
  EXPECT_THAT(found(turned(0.9), {40.0, 42.0, 90.0}, {41.0, 60.0, 88.0}).modes, testing::IsEmpty());
  EXPECT_THAT(found(turned(0.9), {40.0, 42.0, 90.0}, {50.0, 43.0, 88.0}).modes, testing::IsEmpty());
}

TEST(CloseModes, NeedTwoComponentsForEachMode) {
  Eigen::MatrixXd few = turned(0.9);
  few.topRows(5).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(found(few).mac, 0.0);
  few = turned(0.9);
  few.topRows(4).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_NEAR(found(few).mac, 1.0, 1e-9);
}

TEST(CloseModes, TakeAThirdModeWhereTwoDoNotSpanTheShape) {
  Eigen::MatrixXd shapes = turned(0.9);
  shapes.col(0) += 2.0 * shapes.col(2);
  const CloseModes close = found(shapes, {40.0, 42.0, 41.0}, {41.0, 43.0, 42.0});
  EXPECT_EQ(close.modes.size(), 3U);
  EXPECT_NEAR(close.mac, 1.0, 1e-12);
}

}  // namespace
}  // namespace mottle::dynamics
