// A linear model with normal noise whose posterior has a closed form, and the comparison of a sample with it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/estimate/posterior.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

inline constexpr double k_errors = 4.0;  // standard errors: once in 16,000 cases of a normal error

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

inline Eigen::MatrixXd all_points(const std::vector<SampledIsland>& islands) {
  Eigen::MatrixXd all(0, islands.front().points.cols());
  for (const SampledIsland& island : islands) {
    all.conservativeResize(all.rows() + island.points.rows(), Eigen::NoChange);
    all.bottomRows(island.points.rows()) = island.points;
  }
  return all;
}

inline void expect_closed_form(const LinearNormal& exact, const std::vector<SampledIsland>& islands) {
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

inline void expect_closed_form_along_gradients(Eigen::Index dimension) {
  const LinearNormal linear(dimension);
  const std::vector<SampledIsland> islands = sample_posterior(linear.target(), {}, {});
  EXPECT_GT(islands.front().stages.back().trajectories, 0);
  EXPECT_EQ(islands.front().stages.back().divergences, 0);
  expect_closed_form(linear, islands);
}

}  // namespace mottle::test
