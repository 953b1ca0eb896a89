#include "mottle/stats/moments/density_region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

constexpr double k_two_deviations = 0.8646647167633873;  // 1 - exp(-2): of a normal pair within two deviations

Eigen::MatrixXd standard_normal_pairs(Eigen::Index count) {
  const StreamKey key{.seed = 5, .purpose = StreamPurpose::parameter_cloud};
  return uniform_design(SamplingDesign::sobol, count, 2, key).unaryExpr([](double p) {
    return standard_normal_quantile(p);
  });
}

std::vector<Eigen::MatrixXd> outlines_of(const Eigen::MatrixXd& points, double probability) {
  const auto n = static_cast<double>(points.rows());
  return highest_density_outlines(points, Eigen::VectorXd::Constant(points.rows(), 1.0 / n), n, probability);
}

/// Whether a point is within a closed outline, by the edges that a ray to the right crosses.
bool is_inside(const Eigen::MatrixXd& outline, const Eigen::RowVector2d& point) {
  bool inside = false;
  for (Eigen::Index k = 0; k + 1 < outline.rows(); ++k) {
    const auto a = outline.row(k);
    const auto b = outline.row(k + 1);
    if ((a(1) > point(1)) == (b(1) > point(1))) continue;
    if (point(0) < a(0) + (point(1) - a(1)) / (b(1) - a(1)) * (b(0) - a(0))) inside = !inside;
  }
  return inside;
}

double share_inside(const std::vector<Eigen::MatrixXd>& outlines, const Eigen::MatrixXd& points) {
  double count = 0.0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    bool inside = false;
    for (const Eigen::MatrixXd& outline : outlines) inside = inside != is_inside(outline, points.row(i));
    count += inside ? 1.0 : 0.0;
  }
  return count / static_cast<double>(points.rows());
}

TEST(DensityRegion, IsTheEllipseOfANormalPair) {
  Eigen::Matrix2d root;
  root << 0.2, 0.0, 27.0, 13.0;  // a correlation of 0.9, of axes two orders apart
  const Eigen::MatrixXd points = standard_normal_pairs(1 << 14) * root.transpose();
  const std::vector<Eigen::MatrixXd> outlines = outlines_of(points, k_two_deviations);
  ASSERT_EQ(outlines.size(), 1U);
  const Eigen::MatrixXd& outline = outlines.front();
  EXPECT_EQ(Eigen::RowVector2d(outline.row(0)), Eigen::RowVector2d(outline.bottomRows(1)));
  double mean = 0.0;
  for (Eigen::Index k = 0; k + 1 < outline.rows(); ++k) {
    const double distance = root.triangularView<Eigen::Lower>().solve(outline.row(k).transpose()).norm();
    EXPECT_NEAR(distance, 2.0, 0.15);  // the density's relative error there is 7 % for independent points
    mean += distance / static_cast<double>(outline.rows() - 1);
  }
  EXPECT_NEAR(mean, 2.0, 0.02);
}

TEST(DensityRegion, HasAnOutlineOfEachMode) {
  Eigen::MatrixXd points = 0.1 * standard_normal_pairs(1 << 13);
  points.col(0).array() += 1.0;
  points.topRows(1 << 12).col(0).array() -= 2.0;
  const std::vector<Eigen::MatrixXd> outlines = outlines_of(points, k_two_deviations);
  ASSERT_EQ(outlines.size(), 2U);
  for (const Eigen::MatrixXd& outline : outlines) {
    const Eigen::RowVector2d middle = 0.5 * (outline.colwise().minCoeff() + outline.colwise().maxCoeff());
    EXPECT_NEAR(std::abs(middle(0)), 1.0, 0.03);
    const Eigen::RowVector2d half = 0.5 * (outline.colwise().maxCoeff() - outline.colwise().minCoeff());
    EXPECT_NEAR(half(0), 0.2, 0.03);
    EXPECT_NEAR(half(1), 0.2, 0.03);
  }
}

/// A ridge along half a circle: the ellipse of its covariance would contain the empty middle.
TEST(DensityRegion, FollowsACurvedRidge) {
  const Eigen::MatrixXd normals = standard_normal_pairs(1 << 13);
  Eigen::MatrixXd points(normals.rows(), 2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double angle = std::numbers::pi * standard_normal_cdf(normals(i, 0));
    const double radius = 1.0 + 0.05 * normals(i, 1);
    points.row(i) << radius * std::cos(angle), radius * std::sin(angle);
  }
  const std::vector<Eigen::MatrixXd> outlines = outlines_of(points, 0.9);
  ASSERT_EQ(outlines.size(), 1U);
  EXPECT_FALSE(is_inside(outlines.front(), {0.0, 0.6}));
  EXPECT_TRUE(is_inside(outlines.front(), {0.0, 1.0}));
  EXPECT_TRUE(is_inside(outlines.front(), {std::cos(0.6), std::sin(0.6)}));
}

TEST(DensityRegion, HoldsThePartOfThePointsThatIsAskedFor) {
  Eigen::MatrixXd points = standard_normal_pairs(1 << 12);
  points = points.array().exp();  // log-normal: skewed
  for (const double probability : {0.5, 0.9}) {
    // What loops too small to be drawn hold is missing.
    EXPECT_NEAR(share_inside(outlines_of(points, probability), points), probability, 0.02);
  }
}

TEST(DensityRegion, IsNoneForPointsOnALine) {
  Eigen::MatrixXd points = standard_normal_pairs(100);
  points.col(1) = 3.0 * points.col(0);
  EXPECT_TRUE(outlines_of(points, 0.5).empty());
  points.col(0).setZero();
  EXPECT_TRUE(outlines_of(points, 0.5).empty());
}

}  // namespace
}  // namespace mottle::stats
