#include "mottle/stats/moments/distance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/error.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

TEST(Distance, EuclideanIsTheLengthOfTheDifference) {
  EXPECT_EQ(euclidean_distance(Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(4.0, 6.0)), 5.0);
}

// NumPy: sqrt(d @ solve(S, d)).
TEST(Distance, MahalanobisIsThatOfNumpy) {
  Eigen::Matrix3d covariance;
  covariance << 4.0, 1.2, -0.6, 1.2, 2.0, 0.3, -0.6, 0.3, 1.0;
  const Eigen::Vector3d a(1.5, 1.0, 0.25);
  const Eigen::Vector3d b(1.0, 2.0, 0.0);
  EXPECT_TRUE(is_relatively_near(mahalanobis_distance(a, b, covariance), 1.199040490666072, 1e-13));
}

TEST(Distance, MahalanobisDoesNotDependOnUnits) {
  const Eigen::Vector2d units(1e-8, 1e9);
  const Eigen::Matrix2d covariance = (Eigen::Matrix2d() << 2.0, 0.5, 0.5, 1.0).finished();
  const Eigen::Matrix2d scaled = units.asDiagonal() * covariance * units.asDiagonal();
  const Eigen::Vector2d difference(1.0, -2.0);
  const Eigen::Vector2d zero = Eigen::Vector2d::Zero();
  EXPECT_TRUE(is_relatively_near(mahalanobis_distance(units.cwiseProduct(difference), zero, scaled),
                                 mahalanobis_distance(difference, zero, covariance), 1e-12));
}

// y = (u, 2 u), u of variance 4: (3, 6) is 3 / 2 deviations away; (2, -1) scaled is orthogonal to the line.
TEST(Distance, MahalanobisOfASingularCovarianceCountsItsRangeAlone) {
  const Eigen::Matrix2d covariance = (Eigen::Matrix2d() << 4.0, 8.0, 8.0, 16.0).finished();
  const Eigen::Vector2d zero = Eigen::Vector2d::Zero();
  EXPECT_NEAR(mahalanobis_distance(Eigen::Vector2d(3.0, 6.0), zero, covariance), 1.5, 1e-12);
  EXPECT_NEAR(mahalanobis_distance(Eigen::Vector2d(1.0, -2.0), zero, covariance), 0.0, 1e-12);
}

TEST(Distance, MahalanobisLeavesOutAVariableWithoutVariance) {
  const Eigen::Matrix2d covariance = Eigen::Vector2d(4.0, 0.0).asDiagonal();
  EXPECT_DOUBLE_EQ(mahalanobis_distance(Eigen::Vector2d(6.0, 5.0), Eigen::Vector2d::Zero(), covariance), 3.0);
}

TEST(Distance, RefusesSizesThatDoNotMatchAndWhatIsNoCovariance) {
  const Eigen::Vector2d a = Eigen::Vector2d::Zero();
  EXPECT_THROW(static_cast<void>(euclidean_distance(a, Eigen::Vector3d::Zero())), InvalidInput);
  EXPECT_THROW(static_cast<void>(mahalanobis_distance(a, Eigen::Vector3d::Zero(), Eigen::Matrix2d::Identity())),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(mahalanobis_distance(a, a, Eigen::Matrix3d::Identity())), InvalidInput);
  EXPECT_THROW(static_cast<void>(mahalanobis_distance(a, a, -Eigen::Matrix2d::Identity())), InvalidInput);
  EXPECT_THROW(static_cast<void>(mahalanobis_distance(Eigen::Vector2d(NAN, 0.0), a, Eigen::Matrix2d::Identity())),
               InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
