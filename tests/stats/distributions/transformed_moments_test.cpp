#include "mottle/stats/distributions/transformed_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mottle::stats {
namespace {

TEST(TransformedMoments, AreTheLognormalDistributionsForALogarithm) {
  const auto moments = moments_of_transformed({ParameterTransform::Kind::log}, std::exp(0.3 + 0.08),
                                              std::exp(0.38) * std::sqrt(std::expm1(0.16)));
  ASSERT_TRUE(moments);
  EXPECT_NEAR(moments->mean, 0.3, 1e-12);
  EXPECT_NEAR(moments->std, 0.4, 1e-12);
}

TEST(TransformedMoments, GiveBackTheVariablesOwnForALogit) {
  const ParameterTransform transform{ParameterTransform::Kind::logit, 1.0, 4.0};
  for (const auto& [mean, std] : {std::pair(2.5, 0.4), std::pair(1.4, 0.2), std::pair(3.7, 0.15)}) {
    const auto moments = moments_of_transformed(transform, mean, std);
    ASSERT_TRUE(moments);
    const VariableMoments back = moments_of_variables({transform}, Eigen::VectorXd::Constant(1, moments->mean),
                                                      Eigen::MatrixXd::Constant(1, 1, moments->std * moments->std));
    EXPECT_NEAR(back.mean(0), mean, 1e-7);  // that quadrature is another, of 40 points
    EXPECT_NEAR(std::sqrt(back.covariance(0, 0)), std, 1e-7);
  }
}

TEST(TransformedMoments, AreNoneWhereNoPopulationHasThem) {
  EXPECT_FALSE(moments_of_transformed({ParameterTransform::Kind::log}, -1.0, 0.1));
  EXPECT_FALSE(moments_of_transformed({ParameterTransform::Kind::logit, 0.0, 1.0}, 2.0, 0.1));
  EXPECT_FALSE(
      moments_of_transformed({ParameterTransform::Kind::logit, 0.0, 1.0}, 0.5, 0.6));  // at most 0.5, at the two ends
  EXPECT_FALSE(moments_of_transformed({}, std::nan(""), 0.1));
}

TEST(TransformedMoments, HaveTheLognormalDensity) {
  const double expected = 1.0 / (0.2 * std::sqrt(2.0 * std::numbers::pi));
  EXPECT_NEAR(density_of_variable({ParameterTransform::Kind::log}, {0.0, 0.2}, 1.0), expected, 1e-14);
  EXPECT_EQ(density_of_variable({ParameterTransform::Kind::log}, {0.0, 0.2}, -1.0), 0.0);
  EXPECT_EQ(density_of_variable({ParameterTransform::Kind::logit, 0.0, 1.0}, {0.0, 1.0}, 1.0), 0.0);
}

TEST(TransformedMoments, SpreadPointsEvenlyOverTheTransformedVariable) {
  const Eigen::VectorXd points = points_of_variable({ParameterTransform::Kind::log}, {0.0, 1.0}, 2.0, 5);
  EXPECT_NEAR(points(0), std::exp(-2.0), 1e-15);
  EXPECT_NEAR(points(2), 1.0, 1e-15);
  EXPECT_NEAR(points(3), std::exp(1.0), 1e-14);
}

}  // namespace
}  // namespace mottle::stats
