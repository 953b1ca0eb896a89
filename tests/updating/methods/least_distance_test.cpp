#include "updating/methods/least_distance.hpp"

#include <gtest/gtest.h>

#include "mottle/core/random.hpp"

namespace mottle::updating {
namespace {

TEST(NonNegativeLeastSquares, IsThatOfScipy) {
  Eigen::MatrixXd e(4, 3);
  e << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 1.0, 0.0, -1.0;
  const Eigen::VectorXd u = non_negative_least_squares(e, Eigen::Vector4d(1.0, -2.0, 3.0, 4.0));
  EXPECT_LT((u - Eigen::Vector3d(0.26865671641791045, 0.0, 0.0)).norm(), 1e-14);
}

TEST(LeastDistance, IsThatOfScipysSlsqp) {
  Eigen::MatrixXd a(4, 3);
  a << 1.0, 2.0, 0.5, -1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 3.0, -1.0, 0.2;
  const LeastDistance found = least_distance(a, Eigen::Vector4d(2.0, 1.0, -5.0, 0.5));
  ASSERT_TRUE(found.is_feasible);
  EXPECT_LT((found.point - Eigen::Vector3d(0.34090909, 0.65909091, 0.68181818)).norm(), 1e-8);
  EXPECT_LT((a.transpose() * found.pressure - found.point).norm(), 1e-12);
}

TEST(LeastDistance, IsTheOriginWhereThatIsInside) {
  const LeastDistance found = least_distance(Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1.0, 0.0));
  EXPECT_TRUE(found.is_feasible);
  EXPECT_EQ(found.point, Eigen::Vector2d(0.0, 0.0));
}

TEST(LeastDistance, SeesThatAPolyhedronIsEmpty) {
  EXPECT_FALSE(least_distance(Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(1.0, 1.0)).is_feasible);
}

/// Feasible, with no pressure but on rows that hold: the conditions of a minimum that is the only one.
TEST(LeastDistance, FulfilsTheConditionsOfAMinimumInRandomPolyhedra) {
  for (std::uint32_t trial = 0; trial < 500; ++trial) {
    RandomStream stream({.seed = 3, .purpose = StreamPurpose::truth}, trial);
    const auto columns = static_cast<Eigen::Index>(1 + trial % 6);
    const auto rows = static_cast<Eigen::Index>(1 + trial % 17);
    Eigen::MatrixXd a(rows, columns);
    for (double& entry : a.reshaped()) entry = 2.0 * stream.uniform() - 1.0;
    if (rows > 3) a.row(3) = a.row(0);  // rows that depend on one another
    Eigen::VectorXd inside(columns), b(rows);
    for (double& entry : inside) entry = 10.0 * stream.uniform();
    for (Eigen::Index r = 0; r < rows; ++r) b(r) = a.row(r).dot(inside) - stream.uniform();
    const LeastDistance found = least_distance(a, b);
    ASSERT_TRUE(found.is_feasible) << trial;
    EXPECT_GT((a * found.point - b).minCoeff(), -1e-9) << trial;
    EXPECT_GE(found.pressure.minCoeff(), 0.0) << trial;
    EXPECT_LT(std::abs(found.pressure.dot(a * found.point - b)), 1e-8) << trial;
  }
}

}  // namespace
}  // namespace mottle::updating
