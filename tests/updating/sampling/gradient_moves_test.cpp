// Moves along gradients: posteriors of many parameters in closed form, and what a gradient may do wrong.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/estimate/posterior.hpp"

namespace mottle::updating {
namespace {

constexpr double k_errors = 4.0;  // standard errors: once in 16,000 cases of a normal error

/// z = G u + e, e ~ N(0, s^2), u ~ N(0, 1): fewer outputs than parameters, so that the posterior is as wide as the
/// prior in some directions and narrow in others.
struct LinearNormal {
  explicit LinearNormal(Eigen::Index dimension) : slope(2 * dimension / 3, dimension), measured(2 * dimension / 3) {
    RandomStream random({.seed = 11}, static_cast<std::uint32_t>(dimension));
    for (double& entry : slope.reshaped()) {
      entry = standard_normal_quantile(random.uniform()) / std::sqrt(static_cast<double>(dimension));
    }
    for (double& entry : measured) entry = standard_normal_quantile(random.uniform());
    const Eigen::MatrixXd total =
        slope * slope.transpose() + k_noise * k_noise * Eigen::MatrixXd::Identity(measured.size(), measured.size());
    const Eigen::LLT<Eigen::MatrixXd> factor(total);
    mean = slope.transpose() * factor.solve(measured);
    covariance = Eigen::MatrixXd::Identity(dimension, dimension) - slope.transpose() * factor.solve(slope);
    const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
    log_evidence = -0.5 * (static_cast<double>(measured.size()) * std::log(2.0 * std::numbers::pi) + log_determinant +
                           measured.dot(factor.solve(measured)));
  }

  SamplingTarget target() const {
    return {.dimension = slope.cols(),
            .log_likelihood = [this](const Eigen::MatrixXd& points) { return with_gradient(points).log_likelihood; },
            .with_gradient = [this](const Eigen::MatrixXd& points) { return with_gradient(points); }};
  }
  LikelihoodGradient with_gradient(const Eigen::MatrixXd& points) const {
    evaluations += points.rows();
    const Eigen::MatrixXd apart = (-(points * slope.transpose())).rowwise() + measured.transpose();
    const double constant =
        static_cast<double>(measured.size()) * std::log(k_noise * std::sqrt(2.0 * std::numbers::pi));
    return {-0.5 / (k_noise * k_noise) * apart.rowwise().squaredNorm().array() - constant,
            apart * slope / (k_noise * k_noise)};
  }

  static constexpr double k_noise = 0.1;
  Eigen::MatrixXd slope;
  Eigen::VectorXd measured;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double log_evidence = 0.0;
  mutable std::atomic<std::int64_t> evaluations = 0;
};

Eigen::MatrixXd all_points(const std::vector<SampledIsland>& islands) {
  Eigen::MatrixXd all(0, islands.front().points.cols());
  for (const SampledIsland& island : islands) {
    all.conservativeResize(all.rows() + island.points.rows(), Eigen::NoChange);
    all.bottomRows(island.points.rows()) = island.points;
  }
  return all;
}

void expect_closed_form(const LinearNormal& exact, const std::vector<SampledIsland>& islands) {
  const Evidence evidence = combine_evidence(islands);
  // A known bias, of which `bayes` warns: -0.19 in 60 dimensions, eight stated errors.
  const double bias = exact.mean.size() > k_dimensions_of_evidence ? 0.2 : 0.0;
  EXPECT_NEAR(evidence.log_evidence, exact.log_evidence - bias, k_errors * evidence.standard_error + 0.5 * bias);
  EXPECT_LT(evidence.standard_error, 0.2);
  const Eigen::MatrixXd draws = all_points(islands);
  const auto d = static_cast<double>(draws.cols());
  constexpr double k_independent = 2000.0;  // as if a quarter of the 8,000 draws were independent
  const Eigen::LLT<Eigen::MatrixXd> factor(exact.covariance);
  const Eigen::MatrixXd whitened = factor.matrixL().solve((draws.rowwise() - exact.mean.transpose()).transpose());
  EXPECT_LT(whitened.rowwise().mean().cwiseAbs().maxCoeff(), k_errors / std::sqrt(k_independent));
  EXPECT_NEAR(whitened.squaredNorm() / static_cast<double>(draws.rows()), d,
              k_errors * std::sqrt(2.0 * d / k_independent));
  // No entry of the whitened covariance is off by more than its error: of the d^2 / 2 of them the largest is expected
  // at 3.7 errors in 60 dimensions.
  const Eigen::MatrixXd covariance = whitened * whitened.transpose() / static_cast<double>(draws.rows());
  EXPECT_LT((covariance - Eigen::MatrixXd::Identity(draws.cols(), draws.cols())).cwiseAbs().maxCoeff(),
            1.5 * k_errors * std::sqrt(2.0 / k_independent));
}

class ManyParameters : public testing::TestWithParam<int> {};

TEST_P(ManyParameters, HaveTheClosedFormOfALinearModel) {
  const LinearNormal linear(GetParam());
  const std::vector<SampledIsland> islands = sample_posterior(linear.target(), {}, {});
  EXPECT_GT(islands.front().stages.back().trajectories, 0);
  EXPECT_EQ(islands.front().stages.back().divergences, 0);
  expect_closed_form(linear, islands);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, ManyParameters, testing::Values(30, 60));

std::int64_t cost(Eigen::Index dimension, GradientMoves gradients) {
  const LinearNormal linear(dimension);
  sample_posterior(linear.target(), {.particles = 300, .gradients = gradients}, {});
  return linear.evaluations;
}

TEST(GradientMoves, TakeFewerEvaluationsThanOthersInThirtyDimensions) {
  EXPECT_LT(4 * cost(30, GradientMoves::always), cost(30, GradientMoves::never));
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
TEST(GradientMoves, OfAWrongGradientLeaveThePosteriorAsItIs) {
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
              k_errors * std * std::sqrt((1.0 - 2.0 / std::numbers::pi) / 2000.0));
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
