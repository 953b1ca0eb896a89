#include "mottle/model/parameters/parameter_space.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/message_of.hpp"

namespace mottle::model {
namespace {

using ::testing::HasSubstr;

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr PhysicalLimit k_damping{.lower = 0.0, .excludes_lower = false};
constexpr StreamKey k_key{.seed = 5, .purpose = StreamPurpose::parameter_cloud, .iteration = 2};

Distribution normal(double mean, double std) {
  return Distribution({.kind = DistributionKind::normal, .mean = mean, .std = std});
}

/// One stiffness ~ N(mean, std).
ParameterSpace one_parameter(double mean, double std, double lower = -k_infinity, double upper = k_infinity,
                             PhysicalLimit limit = {}) {
  return {{{"k", "N/m", lower, upper, limit}}, JointDistribution({normal(mean, std)})};
}

ParameterDraw draw(const ParameterSpace& space, Eigen::Index samples, const StreamKey& key = k_key) {
  return space.draw(space.prior(), SamplingDesign::monte_carlo, samples, key);
}

// N(1, 0.8) cut at zero, scipy.stats.truncnorm(-1.25, inf, loc=1, scale=0.8) of SciPy 1.10: mean
// mu + sigma phi(a) / Phi(-a), a = -1.25; a draw is rejected with probability Phi(-1.25).
constexpr double k_cut_mean = 1.1633803671189415;
constexpr double k_cut_deviation = 0.6707655987907687;
constexpr double k_rejection = 0.10564977366685535;
constexpr Eigen::Index k_draws = 20000;

TEST(ParameterDraw, FollowsTheDistributionCutAtThePhysicalLimit) {
  const Eigen::VectorXd samples = draw(one_parameter(1.0, 0.8), k_draws).samples.col(0);
  const double standard_error = k_cut_deviation / std::sqrt(static_cast<double>(k_draws));
  EXPECT_NEAR(samples.mean(), k_cut_mean, 4.0 * standard_error);
}

TEST(ParameterDraw, HoldsPossibleSamplesOnly) {
  EXPECT_GT(draw(one_parameter(1.0, 0.8), k_draws).samples.minCoeff(), 0.0);
}

// Rejections of one sample are geometric: mean p / (1 - p), variance p / (1 - p)^2.
TEST(ParameterDraw, CountsEveryRejectedDraw) {
  const double expected = k_draws * k_rejection / (1.0 - k_rejection);
  const double standard_error = std::sqrt(k_draws * k_rejection) / (1.0 - k_rejection);
  EXPECT_NEAR(static_cast<double>(draw(one_parameter(1.0, 0.8), k_draws).rejected), expected, 4.0 * standard_error);
}

TEST(ParameterDraw, RejectsNothingWhereEverythingIsPossible) {
  EXPECT_EQ(draw(one_parameter(100.0, 1.0), 1000).rejected, 0);
}

TEST(ParameterDraw, LeavesSamplesThatWerePossibleAtOnceUntouched) {
  const ParameterSpace space = one_parameter(1.0, 0.8);
  const Eigen::MatrixXd first = space.prior().from_uniform(uniform_design(SamplingDesign::monte_carlo, 1000, 1, k_key));
  const Eigen::MatrixXd samples = draw(space, 1000).samples;
  for (Eigen::Index s = 0; s < 1000; ++s) {
    if (first(s, 0) <= 0.0) continue;
    ASSERT_EQ(samples(s, 0), first(s, 0)) << s;
  }
}

// Redrawn samples of a lower-discrepancy design too must follow the cut distribution; its mean only gains by the
// design.
TEST(ParameterDraw, FollowsTheCutDistributionFromALatinHypercube) {
  const ParameterSpace space = one_parameter(1.0, 0.8);
  const ParameterDraw hypercube = space.draw(space.prior(), SamplingDesign::latin_hypercube, k_draws, k_key);
  const double standard_error = k_cut_deviation / std::sqrt(static_cast<double>(k_draws));
  EXPECT_NEAR(hypercube.samples.mean(), k_cut_mean, 4.0 * standard_error);
}

TEST(ParameterDraw, RedrawsTheWholeSampleWhereOneParameterIsImpossible) {
  const ParameterSpace space({{"k1", "N/m", -k_infinity, k_infinity, {}}, {"k2", "N/m", -k_infinity, k_infinity, {}}},
                             JointDistribution({normal(1.0, 0.8), normal(50.0, 1.0)}));
  const Eigen::MatrixXd first = space.prior().from_uniform(uniform_design(SamplingDesign::monte_carlo, 1000, 2, k_key));
  const Eigen::MatrixXd samples = draw(space, 1000).samples;
  for (Eigen::Index s = 0; s < 1000; ++s) {
    if (first(s, 0) > 0.0) continue;
    ASSERT_NE(samples(s, 1), first(s, 1)) << s;
  }
}

TEST(ParameterDraw, IsAFunctionOfItsKey) {
  const ParameterSpace space = one_parameter(1.0, 0.8);
  EXPECT_EQ(draw(space, 500).samples, draw(space, 500).samples);
  const StreamKey other{.seed = 5, .purpose = StreamPurpose::parameter_cloud, .iteration = 3};
  EXPECT_NE(draw(space, 500).samples, draw(space, 500, other).samples);
}

TEST(ParameterDraw, ShareNoRedrawsBetweenPurposes) {
  const ParameterSpace space = one_parameter(1.0, 0.8);
  const StreamKey truth{.seed = 5, .purpose = StreamPurpose::truth, .iteration = 2};
  const Eigen::VectorXd cloud = draw(space, 500).samples, tests = draw(space, 500, truth).samples;
  EXPECT_TRUE((cloud.array() != tests.array()).all());
}

TEST(ParameterDraw, RefusesADistributionThatIsWhollyImpossible) {
  const ParameterSpace space = one_parameter(1.0, 0.1);
  EXPECT_THAT(test::message_of<InvalidInput>(
                  [&] { space.draw(JointDistribution({normal(-10.0, 0.1)}), SamplingDesign::monte_carlo, 3, k_key); }),
              HasSubstr("almost wholly physically impossible"));
}

TEST(ParameterSpace, ExcludesZeroForStiffnessAndAllowsItForDamping) {
  const Eigen::RowVectorXd zero = Eigen::RowVectorXd::Zero(1);
  EXPECT_FALSE(one_parameter(1.0, 0.1).is_possible(zero));
  EXPECT_TRUE(one_parameter(1.0, 0.1, -k_infinity, k_infinity, k_damping).is_possible(zero));
}

TEST(ParameterSpace, NoNumberIsImpossible) {
  EXPECT_FALSE(
      one_parameter(1.0, 0.1).is_possible(Eigen::RowVectorXd::Constant(1, std::numeric_limits<double>::quiet_NaN())));
}

double clamped(const ParameterSpace& space, double value) {
  return space.clamp(Eigen::VectorXd::Constant(1, value))(0);
}

TEST(Clamp, MovesAValueToTheNearestBound) {
  const ParameterSpace space = one_parameter(2.0, 0.3, 0.5, 3.0);
  EXPECT_EQ(clamped(space, 0.1), 0.5);
  EXPECT_EQ(clamped(space, 7.0), 3.0);
  EXPECT_EQ(clamped(space, 1.7), 1.7);
}

// The documented rule: an excluded limit is approached to a thousandth of the prior mean.
TEST(Clamp, KeepsAnUnboundedStiffnessPositive) {
  EXPECT_EQ(clamped(one_parameter(2.0, 0.3), -5.0), 2e-3);
}

TEST(Clamp, LetsDampingReachZero) {
  EXPECT_EQ(clamped(one_parameter(2.0, 0.3, -k_infinity, k_infinity, k_damping), -5.0), 0.0);
}

int active(const ParameterSpace& space, double value) {
  return space.active_bounds(Eigen::VectorXd::Constant(1, value))(0);
}

TEST(ActiveBounds, MarksTheBoundThatAValueLiesOn) {
  const ParameterSpace space = one_parameter(2.0, 0.3, 0.5, 3.0);
  EXPECT_EQ(active(space, 0.5), -1);
  EXPECT_EQ(active(space, 3.0), 1);
  EXPECT_EQ(active(space, 1.0), 0);
}

TEST(ActiveBounds, AllowARelativeErrorOfABillionth) {
  const ParameterSpace space = one_parameter(2.0, 0.3, 0.5, 3.0);
  EXPECT_EQ(active(space, 3.0 * (1.0 - 0.9e-9)), 1);
  EXPECT_EQ(active(space, 3.0 * (1.0 - 1e-8)), 0);
}

// A density in t/mm^3: everything about it is smaller than 1e-8.
TEST(ActiveBounds, DoNotDependOnTheUnitOfAParameter) {
  const ParameterSpace space = one_parameter(7.85e-9, 1e-10, 7e-9, 8.5e-9);
  EXPECT_EQ(active(space, 7.85e-9), 0);
  EXPECT_EQ(active(space, 7e-9), -1);
  EXPECT_EQ(active(space, 8.5e-9), 1);
}

TEST(ActiveBounds, AreNoneWhereAParameterHasNone) {
  EXPECT_EQ(active(one_parameter(1.0, 0.1), 1e9), 0);
}

std::string refusal(double mean, double lower, double upper, PhysicalLimit limit = {}) {
  return test::message_of<InvalidInput>([&] { one_parameter(mean, 0.1, lower, upper, limit); });
}

TEST(ParameterSpace, RefusesCrossedOrEmptyBounds) {
  EXPECT_EQ(refusal(1.0, 2.0, 0.5), "parameter 'k': bounds [2, 0.5] are crossed or empty");
  EXPECT_THAT(refusal(1.0, 1.0, 1.0), HasSubstr("are crossed or empty"));
}

TEST(ParameterSpace, RefusesAMeanOutsideTheBounds) {
  EXPECT_EQ(refusal(4.0, 0.5, 3.0), "parameter 'k': the mean 4 is outside the bounds [0.5, 3]");
}

TEST(ParameterSpace, RefusesAMeanThatIsPhysicallyImpossible) {
  EXPECT_EQ(refusal(0.0, -1.0, 3.0), "parameter 'k': the mean 0 is physically impossible, it must be > 0");
  EXPECT_EQ(refusal(-0.5, -1.0, 3.0, k_damping),
            "parameter 'k': the mean -0.5 is physically impossible, it must be >= 0");
  EXPECT_EQ(refusal(0.0, -1.0, 3.0, k_damping), "nothing thrown");
}

TEST(ParameterSpace, NeedsAParameter) {
  EXPECT_THROW(ParameterSpace({}, JointDistribution({normal(1.0, 0.1)})), InvalidInput);
}

TEST(ParameterSpace, NeedsAsManyDistributionsAsParameters) {
  EXPECT_THROW(ParameterSpace({{"k", "N/m", 0.0, 2.0, {}}}, JointDistribution({normal(1.0, 0.1), normal(1.0, 0.1)})),
               InvalidInput);
}

TEST(ParameterSpace, NamesItsParameters) {
  EXPECT_THAT(one_parameter(1.0, 0.1).names(), ::testing::ElementsAre("k"));
}

}  // namespace
}  // namespace mottle::model
