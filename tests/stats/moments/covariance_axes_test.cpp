#include "mottle/stats/moments/covariance_axes.hpp"

#include <gtest/gtest.h>

namespace mottle::stats {
namespace {

constexpr double k_rounding = 1e-12;

/// Of two variables with standard deviations 2 and 1e6 and correlation 0.6.
Eigen::MatrixXd two_units() {
  return (Eigen::Matrix2d() << 4.0, 0.6 * 2e6, 0.6 * 2e6, 1e12).finished();
}

TEST(CovarianceAxes, HaveTheEigenvaluesOfTheCorrelation) {
  const CovarianceAxes axes(two_units());
  EXPECT_NEAR(axes.variances()(0), 0.4, k_rounding);  // 1 - rho
  EXPECT_NEAR(axes.variances()(1), 1.6, k_rounding);  // 1 + rho
  EXPECT_NEAR(axes.unit()(1), 1e6, 1e6 * k_rounding);
}

TEST(CovarianceAxes, SymmetricRootTimesItselfIsTheCovarianceInUnits) {
  const CovarianceAxes axes(two_units());
  const Eigen::MatrixXd root = axes.symmetric_root();
  const Eigen::MatrixXd in_units = axes.unit().cwiseInverse().asDiagonal() * root;
  EXPECT_LT((in_units - in_units.transpose()).norm(), k_rounding);
  const Eigen::MatrixXd again = root * root.transpose();
  EXPECT_LT((again - two_units()).cwiseQuotient(two_units()).norm(), k_rounding);
}

TEST(CovarianceAxes, WhiteningMakesTheCovarianceOne) {
  const CovarianceAxes axes(two_units());
  const Eigen::MatrixXd w = axes.whitening(1e-10);
  EXPECT_LT((w * two_units() * w.transpose() - Eigen::Matrix2d::Identity()).norm(), k_rounding);
  const Eigen::Vector2d vector(1.0, -3e5);
  EXPECT_LT((axes.whitened(vector, 1e-10) - w * vector).norm(), k_rounding);
}

TEST(CovarianceAxes, ADirectionWithoutVarianceCountsWithTheSmallest) {
  const CovarianceAxes axes(Eigen::MatrixXd::Ones(2, 2));  // fully correlated
  constexpr double k_min = 1e-4;
  const Eigen::Vector2d across(1.0, -1.0);  // length sqrt(2) where the variance is 0
  EXPECT_NEAR(axes.whitened(across, k_min).norm(), std::sqrt(2.0 / k_min), 1e-6);
}

}  // namespace
}  // namespace mottle::stats
