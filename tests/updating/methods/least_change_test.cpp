#include "updating/methods/least_change.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace mottle::updating {
namespace {

Eigen::MatrixXd tall() {
  Eigen::MatrixXd g(4, 2);
  g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7, 1.5, -0.2;
  return g;
}

TEST(LeastChange, IsLeastSquaresWithMoreOutputsThanParameters) {
  const Eigen::MatrixXd g = tall();
  const Gain gain = least_change_gain(g, Eigen::Vector2d(0.1, 3.0));
  EXPECT_EQ(gain.rank, 2);
  EXPECT_LT((gain.matrix - (g.transpose() * g).inverse() * g.transpose()).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(LeastChange, IsTheShortestInPriorDeviationsWithFewerOutputs) {
  const Eigen::RowVector2d g(1.0, 2.0);
  const Eigen::Vector2d standard_deviation(0.5, 1.5);
  // Lagrange: d = D^2 g' / (g D^2 g') r.
  const Eigen::Vector2d weighted = standard_deviation.cwiseAbs2().asDiagonal() * g.transpose();
  const Gain gain = least_change_gain(g, standard_deviation);
  EXPECT_EQ(gain.rank, 1);
  EXPECT_LT((gain.matrix - weighted / g.dot(weighted)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(LeastChange, TheStepGoesBackToThePriorWhereOutputsDoNotDecide) {
  const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.2});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({prior, prior}));
  const ScaledParameters parameters(space);
  const Eigen::RowVector2d g(1.0, 1.0);
  // From (2.5, 1.5) the sum is right already; the nearest point to (2, 2) with that sum is (2, 2).
  const Eigen::VectorXd step = least_change_step(parameters, Eigen::Vector2d(2.5, 1.5), g, Eigen::VectorXd::Zero(1));
  EXPECT_LT((step - Eigen::Vector2d(-0.5, 0.5)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(LeastChange, AParameterOnItsBoundIsHeldAndTheOthersSolvedForIt) {
  const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.2});
  const ParameterSpace space({{"a", "-", 1.0, 3.0, {}, {}}, {"b", "-"}}, JointDistribution({prior, prior}));
  const ScaledParameters parameters(space);
  const Eigen::MatrixXd g = tall();
  const Eigen::VectorXd residual = g * Eigen::Vector2d(1.0, 0.3);
  const Eigen::VectorXd step = least_change_step(parameters, Eigen::Vector2d(3.0, 2.0), g, residual);
  EXPECT_EQ(step(0), 0.0);
  EXPECT_NEAR(step(1), g.col(1).dot(residual) / g.col(1).squaredNorm(), 1e-14);
}

TEST(LeastChange, OneGroupOrManyTheCovarianceOfTheOutputsIsExplained) {
  const Eigen::MatrixXd g = tall();
  Eigen::Matrix2d truth;
  truth << 0.04, 0.01, 0.01, 0.09;
  const Eigen::Vector2d standard_deviation(0.2, 0.5);
  EXPECT_LT(
      (least_change_covariance(g, standard_deviation, g * truth * g.transpose(), {}) - truth).cwiseAbs().maxCoeff(),
      1e-14);
  const Eigen::Matrix2d diagonal = truth.diagonal().asDiagonal();
  EXPECT_LT((least_change_covariance(g, standard_deviation, g * diagonal * g.transpose(), {0, 1}) - diagonal)
                .cwiseAbs()
                .maxCoeff(),
            1e-14);
}

TEST(LeastChange, AVariancePatternCanBeSeenWhereTheFullCovarianceCannot) {
  // Two outputs of three parameters: three moments for three variances.
  Eigen::MatrixXd g(2, 3);
  g << 1.0, 0.5, 0.2, 0.1, 1.0, -0.7;
  const Eigen::Matrix3d truth = Eigen::Vector3d(0.04, 0.01, 0.09).asDiagonal();
  const Eigen::MatrixXd found =
      least_change_covariance(g, Eigen::Vector3d::Ones(), g * truth * g.transpose(), {0, 1, 2});
  EXPECT_LT((found - truth).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(LeastChange, ANegativeVarianceBecomesZeroAndIsReported) {
  Eigen::MatrixXd covariance(2, 2);
  covariance << 1.0, 2.0, 2.0, 1.0;  // eigenvalues 3 and -1
  EXPECT_TRUE(project_to_covariance(covariance, Eigen::Vector2d::Ones(), {}));
  EXPECT_LT((covariance - Eigen::Matrix2d::Constant(1.5)).cwiseAbs().maxCoeff(), 1e-14);
  Eigen::MatrixXd good = Eigen::Matrix2d::Identity();
  EXPECT_FALSE(project_to_covariance(good, Eigen::Vector2d::Ones(), {}));
  EXPECT_EQ(good, Eigen::MatrixXd(Eigen::Matrix2d::Identity()));
}

}  // namespace
}  // namespace mottle::updating
