#include "mottle/stats/distributions/parameter_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

using Kind = ParameterTransform::Kind;

TEST(ParameterTransform, GoesThereAndBack) {
  for (const ParameterTransform& transform :
       {ParameterTransform{}, ParameterTransform{Kind::log}, ParameterTransform{Kind::logit, 0.5, 3.0}}) {
    EXPECT_NEAR(transform.to_variable(transform.from_variable(1.7)), 1.7, 1e-14);
    const double t = transform.from_variable(1.7);
    const double h = 1e-6;
    EXPECT_NEAR(transform.slope(t), (transform.to_variable(t + h) - transform.to_variable(t - h)) / (2 * h), 1e-8);
  }
}

TEST(ParameterTransform, LogitKeepsItsDigitsFarOut) {
  const ParameterTransform transform{Kind::logit, 0.0, 1.0};
  EXPECT_NEAR(transform.slope(40.0) / std::exp(-40.0), 1.0, 1e-9);
  EXPECT_EQ(transform.slope(40.0), transform.slope(-40.0));
}

TEST(ParameterTransform, MeansOfLogitsStayWithinTheBounds) {
  const std::vector<ParameterTransform> transforms{{Kind::logit, 0.76, 0.8800000000000001}};
  for (const double t : {-800.0, -40.0, -25.0, 25.0, 40.0, 800.0}) {
    const double mean =
        moments_of_variables(transforms, Eigen::VectorXd::Constant(1, t), Eigen::MatrixXd::Constant(1, 1, 1e-6))
            .mean(0);
    EXPECT_GT(mean, transforms[0].lower);
    EXPECT_LT(mean, transforms[0].upper);
    EXPECT_TRUE(std::isfinite(transforms[0].from_variable(mean)));
  }
}

TEST(ParameterTransform, MomentsOfLogarithmsAreThoseOfTheLognormalDistribution) {
  Eigen::Matrix2d covariance;
  covariance << 0.09, 0.03, 0.03, 0.04;
  const VariableMoments moments = moments_of_variables({ParameterTransform{Kind::log}, ParameterTransform{}},
                                                       Eigen::Vector2d(0.2, 1.0), covariance);
  const double mean = std::exp(0.2 + 0.045);
  EXPECT_NEAR(moments.mean(0), mean, 1e-15);
  EXPECT_NEAR(moments.covariance(0, 0), mean * mean * std::expm1(0.09), 1e-15);
  EXPECT_NEAR(moments.covariance(0, 1), 0.03 * mean, 1e-15);  // Stein's lemma
  EXPECT_EQ(moments.covariance(1, 0), moments.covariance(0, 1));
}

TEST(ParameterTransform, MomentsOfALogitAreThoseOfItsSamples) {
  Eigen::Matrix2d covariance;
  covariance << 0.49, 0.2, 0.2, 0.25;
  const std::vector<ParameterTransform> transforms{{Kind::logit, 0.5, 3.0}, {Kind::log}};
  const auto joint = JointDistribution::transformed_normal(transforms, Eigen::Vector2d(0.3, -0.1), covariance);
  const Eigen::Index n = 200000;
  const Eigen::MatrixXd x = joint.from_uniform(uniform_design(SamplingDesign::sobol, n, 2, {.seed = 3}));
  const Eigen::RowVectorXd mean = x.colwise().mean();
  const Eigen::MatrixXd centred = x.rowwise() - mean;
  const Eigen::Matrix2d sampled = centred.transpose() * centred / static_cast<double>(n);
  // A Sobol net of this size integrates smooth functions to about 1e-4 of their deviation.
  EXPECT_LT((mean.transpose() - joint.mean()).cwiseAbs().maxCoeff(), 3e-4);
  EXPECT_LT((sampled - joint.covariance()).cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace mottle::stats
