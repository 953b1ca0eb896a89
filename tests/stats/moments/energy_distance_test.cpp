#include "mottle/stats/moments/energy_distance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

/// Means over equal parts of (0, 1) of a normal quantile function, nearly.
Eigen::MatrixXd normal_grid(Eigen::Index count, double mean, double std) {
  Eigen::MatrixXd values(count, 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    values(k, 0) = mean + std * standard_normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(count));
  }
  return values;
}

/// E|N(mean, std)|.
double mean_absolute(double mean, double std) {
  return std * std::sqrt(2.0 / std::numbers::pi) * std::exp(-0.5 * mean * mean / (std * std)) +
         mean * (1.0 - 2.0 * standard_normal_cdf(-mean / std));
}

TEST(EnergyDistance, IsScipysSquaredForOneVariable) {
  const Eigen::VectorXd x = (Eigen::VectorXd(5) << 0.3, -1.2, 2.5, 0.7, 1.1).finished();
  const Eigen::VectorXd y = Eigen::Vector4d(1.4, 0.2, -0.6, 3.1);
  // scipy.stats.energy_distance(x, y) = 0.4695742752749559, SciPy 1.10
  EXPECT_NEAR(energy_distance(x, y), 0.4695742752749559 * 0.4695742752749559, 1e-14);
  EXPECT_NEAR(energy_distance(y, x), energy_distance(x, y), 1e-15);
}

TEST(EnergyDistance, IsTheSumOverPairsForTwoVariables) {
  Eigen::MatrixXd x(3, 2);
  x << 0.3, 1.0, -1.2, 0.4, 2.5, -0.7;
  Eigen::MatrixXd y(2, 2);
  y << 1.4, 0.1, 0.2, -2.0;
  // 2 cdist(x, y).mean() - cdist(x, x).mean() - cdist(y, y).mean(), scipy.spatial.distance
  EXPECT_NEAR(energy_distance(x, y), 1.562948842653229, 1e-14);
  EXPECT_NEAR(energy_distance(x, x), 0.0, 1e-15);
}

TEST(EnergyDistance, HasTheClosedFormOfTwoNormalDistributions) {
  const double own = 2.0 / std::sqrt(std::numbers::pi);
  const double expected = 2.0 * mean_absolute(0.7, std::sqrt(1.0 + 2.25)) - own - 1.5 * own;
  // The grids lack tails beyond 1 / 2000: their distance is off by less than that part of it.
  EXPECT_NEAR(energy_distance(normal_grid(1000, 0.0, 1.0), normal_grid(1000, 0.7, 1.5)), expected, 2e-3);
}

TEST(EnergyDistance, HasItsUnitVectorsForAGradient) {
  Eigen::MatrixXd x(4, 2);
  x << 0.3, 1.0, -1.2, 0.4, 2.5, -0.7, 0.1, 0.2;
  Eigen::MatrixXd y(3, 2);
  y << 1.4, 0.1, 0.2, -2.0, 0.5, 0.9;
  const Eigen::MatrixXd gradient = 2.0 / 4.0 * (mean_unit_vectors(x, y) - mean_unit_vectors(x, x));
  constexpr double k_step = 1e-6;
  for (Eigen::Index j = 0; j < 4; ++j) {
    for (Eigen::Index k = 0; k < 2; ++k) {
      Eigen::MatrixXd ahead = x;
      Eigen::MatrixXd behind = x;
      ahead(j, k) += k_step;
      behind(j, k) -= k_step;
      const double difference = (energy_distance(ahead, y) - energy_distance(behind, y)) / (2.0 * k_step);
      EXPECT_NEAR(gradient(j, k), difference, 1e-8);
    }
  }
}

TEST(EnergyDistance, RefusesSamplesOfOtherVariables) {
  EXPECT_THROW(energy_distance(Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 3)), InvalidInput);
  EXPECT_THROW(energy_distance(Eigen::MatrixXd::Zero(0, 2), Eigen::MatrixXd::Zero(2, 2)), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
