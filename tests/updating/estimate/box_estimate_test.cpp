#include "mottle/updating/estimate/box_estimate.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "mottle/core/error.hpp"

namespace mottle::updating {
namespace {

BoxEstimate example() {
  return BoxEstimate({Eigen::Vector3d(1.0, -2.0, 5.0), Eigen::Vector3d(4.0, 2.0, 5.0)});
}

TEST(BoxEstimate, HasTheMomentsOfTheUniformDistribution) {
  EXPECT_EQ(example().mean(), Eigen::Vector3d(2.5, 0.0, 5.0));
  EXPECT_EQ(example().covariance(), Eigen::MatrixXd(Eigen::Vector3d(0.75, 16.0 / 12.0, 0.0).asDiagonal()));
  EXPECT_EQ(example().kind(), EstimateKind::box);
  EXPECT_EQ(estimate_kind_text(EstimateKind::box), "box");
}

TEST(BoxEstimate, DrawsFromEndToEnd) {
  EXPECT_EQ(example().from_uniform(Eigen::RowVector3d(0.0, 0.25, 0.7)), Eigen::RowVector3d(1.0, -1.0, 5.0));
  EXPECT_EQ(example().quantile(0, 0.5), 2.5);
}

TEST(BoxEstimate, HasADensityInsideAlone) {
  EXPECT_EQ(example().density(1, Eigen::Vector3d(-2.1, 0.0, 2.0)), Eigen::Vector3d(0.0, 0.25, 0.25));
  EXPECT_EQ(example().density_points(2, 20).size(), 0);
  EXPECT_EQ(example().density_points(0, 20)(19), 4.0);
}

TEST(BoxEstimate, IsItsOwnRegion) {
  const auto outlines = example().region(0, 1, 0.5, 33);
  ASSERT_EQ(outlines.size(), 1U);
  EXPECT_EQ(outlines[0].row(0), outlines[0].row(4));
  EXPECT_EQ(outlines[0].row(2), Eigen::RowVector2d(4.0, 2.0));
  EXPECT_TRUE(example().region(0, 2, 0.5, 33).empty());
}

TEST(BoxEstimate, RefusesEndsThatAreNone) {
  EXPECT_THROW(BoxEstimate({Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(1.0, 1.9)}), InvalidInput);
  EXPECT_THROW(BoxEstimate({Eigen::VectorXd(), Eigen::VectorXd()}), InvalidInput);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(BoxEstimate({Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(1.0, infinity)}), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
