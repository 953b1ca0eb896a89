#include "mottle/stats/moments/wasserstein.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

const Eigen::VectorXd k_five = (Eigen::VectorXd(5) << 0.3, -1.2, 2.5, 0.7, 1.1).finished();
const Eigen::VectorXd k_four = Eigen::Vector4d(1.4, 0.2, -0.6, 3.1);

TEST(WassersteinDistance, AgreesWithScipyForOrderOne) {
  // scipy.stats.wasserstein_distance, SciPy 1.10
  EXPECT_NEAR(wasserstein_distance(k_five, k_four, 1), 0.565, 1e-15);
  EXPECT_NEAR(wasserstein_distance(k_five.head(4), k_four, 1), 0.5, 1e-15);
}

TEST(WassersteinDistance, IsTheBestAssignmentOfCopiesForOrderTwo) {
  // scipy.optimize.linear_sum_assignment of squared differences, the values copied four and five times
  EXPECT_NEAR(wasserstein_distance(k_five, k_four, 2), 0.6881133627535508, 1e-14);
}

TEST(WassersteinDistance, HasTheClosedFormOfNormalDistributionsForOrderTwo) {
  constexpr Eigen::Index k_count = 4000;
  Eigen::VectorXd first(k_count);
  for (Eigen::Index k = 0; k < k_count; ++k)
    first(k) = standard_normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(k_count));
  const Eigen::VectorXd second = 0.7 + 1.5 * first.array();
  // W^2 = (difference of means)^2 + (difference of standard deviations)^2; the grid's variance lacks 1e-3
  EXPECT_NEAR(wasserstein_distance(first, second, 2), std::hypot(0.7, 0.5), 1e-3);
}

TEST(WassersteinDistance, HasMeansOfTheQuantileFunction) {
  const Eigen::VectorXd means = quantile_means(Eigen::Vector3d(3.0, 1.0, 2.0), 2);
  EXPECT_NEAR(means(0), (2.0 * 1.0 + 2.0) / 3.0, 1e-15);
  EXPECT_NEAR(means(1), (2.0 + 2.0 * 3.0) / 3.0, 1e-15);
}

TEST(SlicedWassersteinDistance, IsTheMeanOverDirections) {
  Eigen::MatrixXd x(4, 2);
  x << 0.3, 1.0, -1.2, 0.4, 2.5, -0.7, 0.1, 0.2;
  Eigen::MatrixXd y(4, 2);
  y << 1.4, 0.1, 0.2, -2.0, 0.5, 0.9, -1.0, 1.3;
  Eigen::MatrixXd directions(3, 2);
  directions << 1.0, 0.0, 0.6, 0.8, -0.8, 0.6;
  // scipy.stats.wasserstein_distance of each projection
  const Eigen::Vector3d of_order_one(0.4, 0.34, 0.69);
  for (Eigen::Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(wasserstein_distance(x * directions.row(k).transpose(), y * directions.row(k).transpose(), 1),
                of_order_one(k), 1e-14);
  }
  // numpy: root mean square of differences of sorted projections
  EXPECT_NEAR(sliced_wasserstein_distance(x, y, directions), 0.648279774994305, 1e-14);
}

TEST(RandomDirections, AreUnitVectorsThatTheKeyNames) {
  const StreamKey key{.seed = 4, .purpose = StreamPurpose::abc_directions};
  const Eigen::MatrixXd directions = random_directions(200, 3, key);
  EXPECT_LT((directions.rowwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
  EXPECT_EQ(directions.topRows(50), random_directions(50, 3, key));
  // A component of 200 uniform directions has mean 0 with standard error 0.041.
  EXPECT_LT(directions.colwise().mean().cwiseAbs().maxCoeff(), 0.16);
}

TEST(WassersteinDistance, RefusesAnotherOrderAndNoValues) {
  EXPECT_THROW(wasserstein_distance(k_five, k_four, 3), InvalidInput);
  EXPECT_THROW(wasserstein_distance(k_five, Eigen::VectorXd(), 1), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
