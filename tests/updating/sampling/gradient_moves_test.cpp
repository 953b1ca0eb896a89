// Moves along gradients: posteriors of many parameters in closed form, and what a gradient may do wrong.
#include <gtest/gtest.h>

#include <limits>

#include "support/linear_normal.hpp"

namespace mottle::updating {
namespace {

using test::all_points;
using test::expect_closed_form;
using test::LinearNormal;

TEST(GradientMoves, HaveTheClosedFormOfALinearModelOfThirtyParameters) {
  test::expect_closed_form_along_gradients(30);
}

TEST(GradientMoves, AreForMoreThanFifteenDimensions) {
  for (const Eigen::Index dimension : {Eigen::Index{15}, Eigen::Index{16}}) {
    const LinearNormal linear(dimension);
    const SamplingTarget target = linear.target();
    EXPECT_EQ(follows_gradients(target, {}), dimension == 16);
    EXPECT_TRUE(follows_gradients(target, {.gradients = GradientMoves::always}));
    EXPECT_FALSE(follows_gradients(target, {.gradients = GradientMoves::never}));
  }
  SamplingTarget without;
  without.dimension = 60;
  EXPECT_FALSE(follows_gradients(without, {.gradients = GradientMoves::always}));
}

/// The end of a trajectory is accepted by the likelihood itself.
TEST(GradientMoves, LeaveThePosteriorAsItIsUnderAWrongGradient) {
  const LinearNormal linear(6);
  SamplingTarget target = linear.target();
  target.with_gradient = [&linear](const Eigen::MatrixXd& points) {
    LikelihoodGradient found = linear.with_gradient(points);
    found.gradient = 0.7 * found.gradient + 0.5 * points.array().sin().matrix();
    return found;
  };
  expect_closed_form(linear, sample_posterior(target, {.gradients = GradientMoves::always}, {}));
}

TEST(GradientMoves, CountAnUnknownGradientAsDivergedAndGoOn) {
  const LinearNormal linear(3);
  SamplingTarget target = linear.target();
  target.with_gradient = [&linear](const Eigen::MatrixXd& points) {
    LikelihoodGradient found = linear.with_gradient(points);
    for (Eigen::Index s = 0; s < points.rows(); ++s) {
      if (points(s, 0) > linear.mean(0)) found.gradient(s, 1) = std::numeric_limits<double>::quiet_NaN();
    }
    return found;
  };
  const std::vector<SampledIsland> islands = sample_posterior(target, {.gradients = GradientMoves::always}, {});
  std::int64_t divergences = 0;
  for (const SamplingStage& stage : islands.front().stages) divergences += stage.divergences;
  EXPECT_GT(divergences, 0);
  expect_closed_form(linear, islands);
}

/// Half of a symmetric posterior.
TEST(GradientMoves, KeepToWhatIsPossible) {
  LinearNormal linear(4);
  linear.measured.setZero();
  const LinearNormal& exact = linear;
  SamplingTarget target = exact.target();
  target.is_possible = [](const Eigen::MatrixXd& points) {
    std::vector<bool> possible;
    for (Eigen::Index s = 0; s < points.rows(); ++s) possible.push_back(points(s, 0) > 0.0);
    return possible;
  };
  const std::vector<SampledIsland> islands = sample_posterior(target, {.gradients = GradientMoves::always}, {});
  const Eigen::MatrixXd draws = all_points(islands);
  EXPECT_GT(draws.col(0).minCoeff(), 0.0);
  const double std = std::sqrt(exact.covariance(0, 0));
  EXPECT_NEAR(draws.col(0).mean(), std * std::sqrt(2.0 / std::numbers::pi),
              test::k_errors * std * std::sqrt((1.0 - 2.0 / std::numbers::pi) / 2000.0));
}

TEST(GradientMoves, GiveTheSameBitsAtAnyNumberOfThreads) {
  const LinearNormal linear(16);
  const std::vector<SampledIsland> once = sample_posterior(linear.target(), {.particles = 50}, {.threads = 1});
  for (const int threads : {2, 8}) {
    const std::vector<SampledIsland> again = sample_posterior(linear.target(), {.particles = 50}, {.threads = threads});
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].points, again[i].points);
      EXPECT_EQ(once[i].log_evidence, again[i].log_evidence);
    }
  }
}

}  // namespace
}  // namespace mottle::updating
