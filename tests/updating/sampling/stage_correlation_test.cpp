#include "updating/sampling/stage_correlation.hpp"

#include <gtest/gtest.h>

#include "mottle/core/random.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {
namespace {

Eigen::VectorXd normals(Eigen::Index count, std::uint32_t number) {
  RandomStream random({.seed = 7, .purpose = StreamPurpose::posterior_start}, number);
  return standard_normals(random, count);
}

// 500 independent pairs: the largest of three correlations is beyond 4 / sqrt(500) = 0.18 once in 5,000 sets.
TEST(StageStart, FindsNoCorrelationBetweenIndependentParticles) {
  const StageStart start(normals(500, 1), normals(500, 2));
  EXPECT_LT(start.correlation_with(normals(500, 3), normals(500, 4)), 0.18);
}

TEST(StageStart, HasCorrelationOneWithItself) {
  EXPECT_NEAR(StageStart(normals(500, 1), normals(500, 2)).correlation_with(normals(500, 1), normals(500, 4)), 1.0,
              1e-12);
}

// The foot of a banana: particles that are squares, the farthest of which stays where it is. As products of squares
// about the mean the correlation is 0.3 and more by this particle alone.
TEST(StageStart, IsNotHeldByOneParticleOfALongTail) {
  Eigen::VectorXd before = normals(500, 1).array().square();
  Eigen::VectorXd now = normals(500, 3).array().square();
  before(0) = now(0) = 20.0;
  EXPECT_LT(StageStart(before, normals(500, 2)).correlation_with(now, normals(500, 4)), 0.18);
  const Eigen::ArrayXd a = (before.array() - before.mean()).square();
  const Eigen::ArrayXd b = (now.array() - now.mean()).square();
  const double products = ((a - a.mean()) * (b - b.mean())).sum() /
                          std::sqrt((a - a.mean()).square().sum() * (b - b.mean()).square().sum());
  EXPECT_GT(products, 0.3);
}

// One in twenty stays, the farthest on both sides: 25 of 500 whose folded scores are 1.96 and more have a sum of
// squares of 0.21 of all.
TEST(StageStart, SeesTailsThatStay) {
  const Eigen::VectorXd before = normals(500, 1);
  Eigen::VectorXd now = normals(500, 3).unaryExpr([](double u) { return std::clamp(u, -1.9, 1.9); });
  for (Eigen::Index i = 0; i < 500; ++i) now(i) = std::abs(before(i)) > 1.96 ? before(i) : now(i);
  EXPECT_GT(StageStart(before, normals(500, 2)).correlation_with(now, normals(500, 4)), 0.15);
}

// An order-preserving change of the axis changes no rank; a constant column says nothing.
TEST(StageStart, KnowsRanksAlone) {
  const Eigen::VectorXd flat = Eigen::VectorXd::Zero(500);
  EXPECT_NEAR(StageStart(normals(500, 1), flat).correlation_with(normals(500, 1).array().exp(), flat), 1.0, 1e-12);
}

}  // namespace
}  // namespace mottle::updating
