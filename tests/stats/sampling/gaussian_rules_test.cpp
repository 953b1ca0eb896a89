#include "mottle/stats/sampling/gaussian_rules.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

/// E[w1^a w2^b ...] by the rule.
double moment(const GaussianRule& rule, const std::vector<int>& powers) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < rule.weights.size(); ++i) {
    double term = rule.weights(i);
    for (std::size_t j = 0; j < powers.size(); ++j)
      term *= std::pow(rule.points(i, static_cast<Eigen::Index>(j)), powers[j]);
    sum += term;
  }
  return sum;
}

TEST(GaussianRules, HermiteRuleOfThreePointsIsTheTabulatedOne) {
  const GaussianRule rule = hermite_rule(3);
  EXPECT_NEAR(rule.points(0, 0), -std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(rule.points(1, 0), 0.0, 1e-14);
  EXPECT_NEAR(rule.weights(0), 1.0 / 6.0, 1e-14);
  EXPECT_NEAR(rule.weights(1), 2.0 / 3.0, 1e-14);
}

TEST(GaussianRules, TensorRuleGivesTheMomentsOfIndependentNormals) {
  const GaussianRule rule = tensor_hermite_rule(3, 5);
  EXPECT_EQ(rule.weights.size(), 125);
  EXPECT_NEAR(moment(rule, {0, 0, 0}), 1.0, 1e-13);
  EXPECT_NEAR(moment(rule, {8, 0, 0}), 105.0, 1e-10);
  EXPECT_NEAR(moment(rule, {4, 6, 2}), 3.0 * 15.0 * 1.0, 1e-10);
  EXPECT_NEAR(moment(rule, {1, 3, 2}), 0.0, 1e-12);
}

TEST(GaussianRules, FifthDegreeRuleIsExactToDegreeFiveInAnyDimension) {
  for (const Eigen::Index dimension : {1, 2, 3, 7, 18}) {
    const GaussianRule rule = fifth_degree_rule(dimension);
    EXPECT_EQ(rule.weights.size(), 2 * dimension * dimension + 1);
    EXPECT_NEAR(moment(rule, {0}), 1.0, 1e-12);
    EXPECT_NEAR(moment(rule, {2}), 1.0, 1e-12);
    EXPECT_NEAR(moment(rule, {4}), 3.0, 1e-12);
    EXPECT_NEAR(moment(rule, {5}), 0.0, 1e-12);
    if (dimension == 1) continue;
    EXPECT_NEAR(moment(rule, {2, 2}), 1.0, 1e-12);
    EXPECT_NEAR(moment(rule, {3, 1}), 0.0, 1e-12);
    EXPECT_NEAR(moment(rule, {1, 1}), 0.0, 1e-12);
  }
}

TEST(GaussianRules, StandardisedPointsHaveExactMeanAndCovariance) {
  const Eigen::MatrixXd uniforms = uniform_design(SamplingDesign::sobol, 200, 4, {.seed = 3});
  const GaussianRule rule = standardised_rule(uniforms);
  const Eigen::VectorXd mean = rule.points.transpose() * rule.weights;
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 1e-13);
  const Eigen::MatrixXd covariance = rule.points.transpose() * rule.weights.asDiagonal() * rule.points;
  EXPECT_LT((covariance - Eigen::MatrixXd::Identity(4, 4)).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(GaussianRules, RefuseWhatTheyCannotMake) {
  EXPECT_THROW(hermite_rule(0), InvalidInput);
  EXPECT_THROW(tensor_hermite_rule(20, 5), InvalidInput);
  EXPECT_THROW(standardised_rule(Eigen::MatrixXd::Constant(3, 3, 0.5)), InvalidInput);
  EXPECT_THROW(standardised_rule(Eigen::MatrixXd::Constant(9, 3, 0.5)), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
