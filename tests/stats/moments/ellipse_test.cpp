#include "mottle/stats/moments/ellipse.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

Eigen::Matrix2d symmetric(double a, double c, double b) {
  return (Eigen::Matrix2d() << a, c, c, b).finished();
}

// Eigenvalues 9 and 1 with the first eigenvector at 30 degrees: by hand.
TEST(Ellipse, AxesAndAngleAreThoseOfTheCovariance) {
  const Ellipse ellipse = sigma_ellipse(Eigen::Vector2d(4.0, 5.0), symmetric(7.0, 2.0 * std::sqrt(3.0), 3.0), 2.0);
  EXPECT_EQ(ellipse.centre, Eigen::Vector2d(4.0, 5.0));
  EXPECT_NEAR(ellipse.semi_major, 6.0, 1e-14);
  EXPECT_NEAR(ellipse.semi_minor, 2.0, 1e-14);
  EXPECT_NEAR(ellipse.angle, std::numbers::pi / 6.0, 1e-15);
}

TEST(Ellipse, PointsOnItHaveTheMahalanobisDistanceAskedFor) {
  const Eigen::Matrix2d covariance = symmetric(2.0, -0.9, 0.6);
  const Ellipse ellipse = sigma_ellipse(Eigen::Vector2d::Zero(), covariance, 2.0);
  for (const double t : {0.0, 0.4, 1.3, 3.0}) {
    const Eigen::Vector2d local(ellipse.semi_major * std::cos(t), ellipse.semi_minor * std::sin(t));
    const double cosine = std::cos(ellipse.angle);
    const double sine = std::sin(ellipse.angle);
    const Eigen::Vector2d point(cosine * local[0] - sine * local[1], sine * local[0] + cosine * local[1]);
    EXPECT_NEAR(point.dot(covariance.inverse() * point), 4.0, 1e-12);
  }
}

TEST(Ellipse, AngleLiesAboveMinusAndUpToPlusARightAngle) {
  const auto angle = [](double a, double c, double b) {
    return sigma_ellipse(Eigen::Vector2d::Zero(), symmetric(a, c, b), 1.0).angle;
  };
  EXPECT_EQ(angle(4.0, 0.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(angle(1.0, 0.0, 4.0), std::numbers::pi / 2.0);
  EXPECT_DOUBLE_EQ(angle(1.0, -0.0, 4.0), std::numbers::pi / 2.0);
  EXPECT_DOUBLE_EQ(angle(2.0, -1.0, 2.0), -std::numbers::pi / 4.0);
  EXPECT_EQ(angle(1.0, 0.0, 1.0), 0.0);
}

TEST(Ellipse, SingularCovarianceGivesASegmentAndZeroAPoint) {
  const Ellipse segment = sigma_ellipse(Eigen::Vector2d::Zero(), symmetric(1.0, 2.0, 4.0), 1.0);
  EXPECT_NEAR(segment.semi_major, std::sqrt(5.0), 1e-14);
  EXPECT_EQ(segment.semi_minor, 0.0);
  const Ellipse point = sigma_ellipse(Eigen::Vector2d::Zero(), symmetric(0.0, 0.0, 0.0), 1.0);
  EXPECT_EQ(point.semi_major, 0.0);
  EXPECT_EQ(point.semi_minor, 0.0);
}

// cov = diag rotated by 45 degrees, eigenvalues 2 and 1e-14: 1 - c^2 keeps no digit, (1 - c)(1 + c) one.
TEST(Ellipse, KeepsItsWidthWhenThin) {
  const Ellipse ellipse = sigma_ellipse(Eigen::Vector2d::Zero(), symmetric(1.0, 1.0 - 0x1p-40, 1.0), 1.0);
  EXPECT_NEAR(ellipse.semi_minor / std::sqrt(0x1p-40), 1.0, 1e-9);
}

TEST(Ellipse, PairsComeInOrderWithTheirIndices) {
  const Eigen::Vector3d mean(1.0, 2.0, 3.0);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(9.0, 4.0, 1.0).asDiagonal();
  const std::vector<Ellipse> ellipses = pairwise_ellipses(mean, covariance, 1.0);
  ASSERT_EQ(ellipses.size(), 3U);
  EXPECT_EQ(ellipses[1].first, 0);
  EXPECT_EQ(ellipses[1].second, 2);
  EXPECT_EQ(ellipses[2].first, 1);
  EXPECT_EQ(ellipses[2].centre, Eigen::Vector2d(2.0, 3.0));
  EXPECT_DOUBLE_EQ(ellipses[2].semi_major, 2.0);
}

TEST(Ellipse, RefusesWhatIsNoCovariance) {
  const Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  EXPECT_THROW(static_cast<void>(sigma_ellipse(mean, symmetric(1.0, 1.1, 1.0), 1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(sigma_ellipse(mean, symmetric(-1.0, 0.0, 1.0), 1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(sigma_ellipse(mean, symmetric(NAN, 0.0, 1.0), 1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(sigma_ellipse(mean, symmetric(1.0, 0.0, 1.0), 0.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(sigma_ellipse(mean, Eigen::Matrix3d::Identity(), 1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(pairwise_ellipses(mean, Eigen::Matrix3d::Identity(), 1.0)), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
