#include "mottle/updating/verdict/hidden_errors.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Two outputs, one parameter that moves the first alone, an error that moves them by 3 and 0.5.
LinearTests one_parameter(Eigen::Index specimens) {
  return {.sensitivity = Eigen::Vector2d(1.0, 0.0),
          .errors = Eigen::Vector2d(3.0, 0.5),
          .covariance = Eigen::Vector2d(0.04, 0.01).asDiagonal(),
          .values = Eigen::MatrixXd::Zero(specimens, 2),
          .model_error_std = {}};
}

TEST(HiddenErrors, HaveTheClosedFormOfOneParameter) {
  const ErrorEffects effects = error_effects(one_parameter(10));
  EXPECT_EQ(effects.means_degrees_of_freedom, 1);
  EXPECT_EQ(effects.denominator_degrees_of_freedom, 9);
  EXPECT_NEAR(effects.noncentrality(0), 10.0 * 0.25 / 0.01, 1e-9);
  EXPECT_NEAR(effects.shift(0, 0), 3.0, 1e-12);
  EXPECT_NEAR(effects.mean_covariance(0, 0), 0.004, 1e-12);
}

TEST(HiddenErrors, AMissingEntryTakesItsSpecimenOutOfTheOutputAlone) {
  LinearTests tests = one_parameter(10);
  tests.values(3, 1) = k_nan;
  const ErrorEffects effects = error_effects(tests);
  EXPECT_NEAR(effects.noncentrality(0), 9.0 * 0.25 / 0.01, 1e-9);
  EXPECT_NEAR(effects.mean_covariance(0, 0), 0.004, 1e-12);
  EXPECT_EQ(effects.denominator_degrees_of_freedom, 8);
}

TEST(HiddenErrors, AModelErrorDoesNotShrinkWithTheSpecimens) {
  LinearTests tests = one_parameter(10);
  tests.model_error_std = Eigen::Vector2d(0.1, 0.05);
  const ErrorEffects effects = error_effects(tests);
  EXPECT_NEAR(effects.noncentrality(0), 0.25 / (0.001 + 0.0025), 1e-8);
  EXPECT_NEAR(effects.mean_covariance(0, 0), 0.004 + 0.01, 1e-12);
}

TEST(HiddenErrors, NothingRemainsWhereThereAreAsManyParametersAsOutputs) {
  LinearTests tests = one_parameter(10);
  tests.sensitivity = Eigen::Matrix2d{{1.0, 0.4}, {0.2, 2.0}};
  tests.covariance = tests.sensitivity * tests.sensitivity.transpose();
  const ErrorEffects effects = error_effects(tests);
  EXPECT_EQ(effects.means_degrees_of_freedom, 0);
  EXPECT_EQ(effects.noncentrality(0), 0.0);
  EXPECT_LT((effects.shift - tests.sensitivity.inverse() * tests.errors).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(HiddenErrors, WithoutDegreesOfFreedomAreStatedAtTheirSizeOrWhereABoundEndsThem) {
  LinearTests tests = one_parameter(10);
  tests.sensitivity = Eigen::Matrix2d::Identity();
  tests.errors = Eigen::Matrix2d{{3.0, 20.0}, {0.5, -20.0}};
  const MeansTest rule{.denominator = k_infinity,
                       .half_widths = Eigen::Vector2d(0.1, 0.2),
                       .room_below = Eigen::Vector2d(1.0, 1.0),
                       .room_above = Eigen::Vector2d(0.5, 2.0)};
  const std::vector<HiddenError> errors = hidden_errors(error_effects(tests), rule);
  EXPECT_FALSE(errors[0].is_detected);
  EXPECT_NEAR(errors[0].relative_change, 0.1, 1e-12);
  EXPECT_NEAR(errors[0].would_move(0), 3.0, 1e-9);   // 3.0 * 0.1 / 0.1
  EXPECT_NEAR(errors[0].would_move(1), 0.25, 1e-9);  // 0.5 * 0.1 / 0.2
  EXPECT_NEAR(errors[0].harm(), 3.0, 1e-9);
  // Up: 0.5 above the first ends it at 0.025; down: 1.0 below the first and 2.0 above the second at 0.05.
  EXPECT_NEAR(errors[1].relative_change, 0.05, 1e-12);
}

/// Noncentrality of chi-squared at 5 % and a power of 80 %, as in every table of power: the square of u(0.975) + u(0.8)
/// for one degree of freedom. For F: a one-sample t test of an effect of 0.5 with 34 subjects has a power of 80.8 %,
/// with 33 one of 79.5 %.
TEST(HiddenErrors, AreDetectedAtTheSizeThatTheTestRefuses) {
  const MeansTest rule{.denominator = k_infinity,
                       .half_widths = Eigen::VectorXd::Constant(1, 0.1),
                       .room_below = Eigen::VectorXd::Ones(1),
                       .room_above = Eigen::VectorXd::Ones(1)};
  const HiddenError error = hidden_errors(error_effects(one_parameter(10)), rule).front();
  EXPECT_TRUE(error.is_detected);
  EXPECT_NEAR(error.relative_change, std::sqrt(7.849 / 250.0), 1e-4);
  EXPECT_NEAR(error.would_move(0), 3.0 * error.relative_change / 0.1, 1e-12);

  MeansTest estimated = rule;
  estimated.denominator = 33.0;
  const double needed =
      std::pow(hidden_errors(error_effects(one_parameter(10)), estimated)[0].relative_change, 2) * 250;
  EXPECT_GT(needed, 33 * 0.25);
  EXPECT_LT(needed, 34 * 0.25);
}

TEST(HiddenErrors, MoveNothingThatTheTestsDoNotSee) {
  LinearTests tests = one_parameter(10);
  tests.sensitivity = Eigen::Matrix2d{{1.0, 0.0}, {0.0, 0.0}};
  const ErrorEffects effects = error_effects(tests);
  EXPECT_EQ(effects.means_degrees_of_freedom, 1);
  EXPECT_EQ(effects.shift(1, 0), 0.0);
  EXPECT_EQ(effects.mean_covariance(1, 1), 0.0);
}

/// One parameter moves both outputs alike; an error moves the first. Within a specimen the test has their difference,
/// of variance 2, and none where the second is missing. The means themselves would show more: 10 against 6 specimens.
TEST(HiddenErrors, ShowOnlyInSpecimensThatHaveTheOutputs) {
  LinearTests tests{.sensitivity = Eigen::Vector2d(1.0, 1.0),
                    .errors = Eigen::Vector2d(1.0, 0.0),
                    .covariance = Eigen::Matrix2d{{1.5, 0.5}, {0.5, 1.5}},
                    .values = Eigen::MatrixXd::Zero(10, 2),
                    .model_error_std = {},
                    .noise = Eigen::Vector2d(1.0, 1.0)};
  tests.values.col(1).head(4).setConstant(k_nan);
  const ErrorEffects effects = error_effects(tests);
  EXPECT_EQ(effects.means_degrees_of_freedom, 1);
  EXPECT_EQ(effects.denominator_degrees_of_freedom, 5);
  EXPECT_NEAR(effects.noncentrality(0), 6.0 / 2.0, 1e-9);
  // With an error of the model d1 - d2 of variance 2 * 0.25 = 1/2: 1 / (2/6 + 1/2).
  tests.model_error_std = Eigen::Vector2d(0.5, 0.5);
  EXPECT_NEAR(error_effects(tests).noncentrality(0), 1.0 / (2.0 / 6.0 + 0.5), 1e-9);
}

/// The curvature of the outputs adds to what a cloud says of the unmoved direction: variance 0.04 of a test, 0.01 of
/// the cloud's mean.
TEST(HiddenErrors, ShowAgainstTheCovarianceOfTheTestOfMeans) {
  LinearTests tests = one_parameter(10);
  tests.of_test = Eigen::Vector2d(0.04, 0.04).asDiagonal();
  tests.of_cloud = Eigen::Vector2d(0.01, 0.01).asDiagonal();
  EXPECT_NEAR(error_effects(tests).noncentrality(0), 0.25 / (0.004 + 0.01), 1e-9);
  tests.values(3, 1) = k_nan;
  EXPECT_NEAR(error_effects(tests).noncentrality(0), 0.25 / (0.04 / 9.0 + 0.01), 1e-9);
}

TEST(HiddenErrors, NothingIsDetectedByATestThatWasNotMade) {
  const MeansTest rule{.denominator = 0.0,
                       .half_widths = Eigen::VectorXd::Constant(1, 0.1),
                       .room_below = Eigen::VectorXd::Ones(1),
                       .room_above = Eigen::VectorXd::Ones(1)};
  EXPECT_FALSE(hidden_errors(error_effects(one_parameter(10)), rule).front().is_detected);
}

TEST(HiddenErrors, WithoutAnIntervalMoveAMeanByPriorDeviations) {
  const MeansTest rule{.denominator = k_infinity,
                       .half_widths = Eigen::VectorXd::Zero(1),
                       .prior_std = Eigen::VectorXd::Constant(1, 0.2),
                       .room_below = Eigen::VectorXd::Ones(1),
                       .room_above = Eigen::VectorXd::Ones(1)};
  const HiddenError error = hidden_errors(error_effects(one_parameter(10)), rule).front();
  EXPECT_TRUE(std::isnan(error.would_move(0)));
  EXPECT_NEAR(error.prior_deviations(0), 3.0 * error.relative_change / 0.2, 1e-12);
  EXPECT_NEAR(error.harm(), error.prior_deviations(0), 1e-12);
  EXPECT_TRUE(error.is_beyond_first_order());  // 3 * 0.177 = 0.53 is more than 0.2
}

TEST(HiddenErrors, ACovarianceThatIsNotDefiniteIsRefused) {
  LinearTests tests = one_parameter(2);
  tests.covariance(1, 1) = -1.0;
  EXPECT_THROW(error_effects(tests), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
