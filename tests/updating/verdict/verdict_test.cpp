#include "mottle/updating/verdict/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "support/instrumented.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"
#include "updating/methods/mares.hpp"
#include "updating/methods/mean_limits.hpp"
#include "updating/verdict/scatter_tests.hpp"

namespace mottle::updating {
namespace {

using test::frequencies_of;
using test::oracle_parameters;
using test::ThreeMasses;

TEST(Verdict, WithAsManyOutputsAsParametersNothingWasTested) {
  const ThreeMasses structure;
  const UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  const Verdict verdict = judge(problem, MaresUpdater({}).update(problem, {}));
  EXPECT_EQ(verdict.conclusion, Conclusion::undecided);
  EXPECT_TRUE(verdict.tests.empty());
  ASSERT_EQ(verdict.not_tested.size(), 2U);
  EXPECT_NE(verdict.not_tested[0].find("3 outputs are no more than the identifiable combinations"), std::string::npos);
  EXPECT_NE(verdict.not_tested[1].find("maximum-likelihood"), std::string::npos);
}

TEST(Verdict, AParameterOnItsBoundIsInadequateAndNamed) {
  const ThreeMasses truth(3.0);
  const ThreeMasses without_k6(0.0);
  const UpdatingProblem problem = without_k6.problem(frequencies_of(truth, oracle_parameters()));
  const Verdict verdict = judge(problem, MaresUpdater({}).update(problem, {}));
  EXPECT_EQ(verdict.conclusion, Conclusion::inadequate);
  bool is_named = false;
  for (const std::string& reason : verdict.reasons) {
    is_named = is_named || reason.find("k2 ended on its lower bound, 0.5") != std::string::npos;
  }
  EXPECT_TRUE(is_named);
}

TEST(Verdict, AnIterationThatDidNotConvergeIsUndecided) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.iterations = 2;
  EXPECT_EQ(judge(problem, MaresUpdater({}).update(problem, {})).conclusion, Conclusion::undecided);
}

TEST(TestPlan, SharesTheLevelSoThatAllTestsTogetherHaveIt) {
  TestPlan plan;
  plan.add(chi_squared_test("first", 5.0, 2.0));
  plan.add(chi_squared_test("second", 5.0, 2.0));
  PlannedTest small = chi_squared_test("third", 100.0, 2.0);
  small.share = 0.5;
  plan.add(small);
  UpdatingResult result;
  plan.make(0.05, result);
  double passes = 1.0;  // chi-squared with two degrees of freedom: P(> c) = exp(-c / 2)
  for (const VerdictTest& test : result.tests) passes *= 1.0 - std::exp(-0.5 * test.critical);
  EXPECT_NEAR(passes, 0.95, 1e-9);
  EXPECT_TRUE(result.tests[0].passed);
  EXPECT_FALSE(result.tests[2].passed);
}

TEST(TestPlan, SaysOfATestWithoutPowerThatItTestedNothing) {
  TestPlan plan;
  PlannedTest test = chi_squared_test("means", 0.0, 1.0);
  test.aspect = Aspect::means;
  test.power = [](double) { return Power{"an error of 9", false}; };
  plan.add(test);
  UpdatingResult result;
  plan.make(0.05, result);
  ASSERT_EQ(result.not_tested.size(), 1U);
  EXPECT_NE(result.not_tested[0].find("only an error of 9 would have been found"), std::string::npos);
}

/// Ten specimens of a linear model with two parameters and four outputs, drawn anew for each replication.
struct Replication {
  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(4, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7, 1.5, -0.2;
    return g;
  }
  Replication() : model(Eigen::Vector4d::Zero(), slope()) {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.5});
    space = std::make_unique<ParameterSpace>(
        std::vector<Parameter>{{"a", "-", -9.0, 9.0, {-9.0, false}}, {"b", "-", -9.0, 9.0, {-9.0, false}}},
        JointDistribution({prior, prior}));
  }
  Eigen::MatrixXd draw(std::uint32_t replication) const {
    Eigen::MatrixXd tests(10, 4);
    for (std::uint32_t s = 0; s < 10; ++s) {
      RandomStream stream({.seed = 5, .purpose = StreamPurpose::truth, .iteration = replication}, s);
      const auto normal = [&] { return standard_normal_quantile(stream.uniform()); };
      const Eigen::Vector2d x(1.2 + 0.2 * normal(), 0.9 + 0.3 * normal());
      tests.row(s) = (slope() * x).transpose();
      for (Eigen::Index k = 0; k < 4; ++k) tests(s, k) += noise * normal();
    }
    return tests;
  }
  /// Parts of 400 replications that are inadequate and adequate.
  std::pair<double, double> judged(const std::string& method, double known_noise, double offset) const {
    constexpr int k_replications = 400;
    const std::unique_ptr<Updater> updater = find_method(method).make({}, "test");
    double inadequate = 0.0;
    double adequate = 0.0;
    for (std::uint32_t r = 0; r < k_replications; ++r) {
      Eigen::MatrixXd tests = draw(r);
      tests.col(3).array() += offset;
      const UpdatingProblem problem{.model = model,
                                    .space = *space,
                                    .tests = {tests, Eigen::Vector4d::Constant(known_noise)},
                                    .cloud = {.samples = 1000}};
      const Conclusion conclusion = judge(problem, updater->update(problem, {.seed = r + 1})).conclusion;
      inadequate += conclusion == Conclusion::inadequate ? 1.0 / k_replications : 0.0;
      adequate += conclusion == Conclusion::adequate ? 1.0 / k_replications : 0.0;
    }
    return {inadequate, adequate};
  }
  double noise = 0.1;
  test::LinearModel model;
  std::unique_ptr<ParameterSpace> space;
};

/// Three standard errors of 5 % in 400 replications.
constexpr double k_chance = 0.033;

TEST(MatchedMeans, AreRefusedAsOftenAsTheLevelSaysWhereTheNoiseIsKnown) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  for (const char* method : {"perturbation", "inversion", "mares"}) {
    const auto [inadequate, adequate] = Replication().judged(method, 0.1, 0.0);
    EXPECT_NEAR(inadequate, 0.05, k_chance) << method;
    EXPECT_NEAR(adequate, method == std::string("mares") ? 0.0 : 0.95, k_chance) << method;
  }
}

TEST(MatchedMeans, AreTestedByHotellingWhereTheNoiseIsNotKnownAndTheScatterStaysUndecided) {
  const auto [inadequate, adequate] = Replication().judged("perturbation", 0.0, 0.0);
  EXPECT_NEAR(inadequate, 0.05, k_chance);
  EXPECT_EQ(adequate, 0.0);
}

TEST(MatchedMeans, RefuseAWrongModel) {
  EXPECT_GT(Replication().judged("perturbation", 0.1, 0.5).first, 0.98);
  EXPECT_GT(Replication().judged("perturbation", 0.0, 0.5).first, 0.9);
}

/// Part of 400 free means about `truth`, in standard errors, that the bound test refuses. Both parameters have the
/// physical limit 0; `correlation` is that of their means.
double refused_at_limits(const Eigen::Vector2d& truth, double correlation) {
  constexpr std::uint32_t k_replications = 400;
  constexpr double k_error = 0.01;
  const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.3});
  const Parameter first{"a", "-", -9.0, 9.0, {0.0, false}};
  const Parameter second{"b", "-", -9.0, 9.0, {0.0, false}};
  const ParameterSpace space({first, second}, JointDistribution({prior, prior}));
  const test::LinearModel model(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity());
  const UpdatingProblem problem{.model = model, .space = space};
  Eigen::Matrix2d covariance;
  covariance << 1.0, correlation, correlation, 1.0;
  double refused = 0.0;
  for (std::uint32_t r = 0; r < k_replications; ++r) {
    RandomStream stream({.seed = 11, .purpose = StreamPurpose::truth}, r);
    const double u = standard_normal_quantile(stream.uniform());
    const double v = standard_normal_quantile(stream.uniform());
    const Eigen::Vector2d noise(u, correlation * u + std::sqrt(1.0 - correlation * correlation) * v);
    TestPlan plan;
    plan_bound_test(problem, {k_error * (truth + noise), k_error * k_error * covariance, 1e9}, plan);
    UpdatingResult result;
    plan.make(0.05, result);
    for (const VerdictTest& test : result.tests) refused += test.passed ? 0.0 : 1.0 / k_replications;
  }
  return refused;
}

TEST(Bounds, RefuseMeansOnTheirPhysicalLimitsAsOftenAsTheLevelSays) {
  EXPECT_NEAR(refused_at_limits({0.0, 100.0}, 0.0), 0.05, k_chance);  // one
  EXPECT_LE(refused_at_limits({0.8, 100.0}, 0.0), 0.05);
  EXPECT_GT(refused_at_limits({-5.0, 100.0}, 0.0), 0.99);
}

TEST(NearestNonNegative, IsTheProjectionInTheMetricOfTheCovariance) {
  Eigen::Matrix2d covariance;
  covariance << 1.0, 0.6, 0.6, 2.0;
  // One coordinate beyond: the other follows by regression, 0.4 + 0.6 (0 - (-0.5)) / 1.
  EXPECT_LT((nearest_non_negative(Eigen::Vector2d(-0.5, 0.4), covariance) - Eigen::Vector2d(0.0, 0.7)).norm(), 1e-9);
  EXPECT_LT((nearest_non_negative(Eigen::Vector2d(0.5, 0.4), covariance) - Eigen::Vector2d(0.5, 0.4)).norm(), 1e-12);
}

TEST(Identifiability, SingularValuesOfAScaledDiagonalSensitivityAreItsRatios) {
  const Eigen::Matrix2d g = Eigen::Vector2d(4.0, 3.0).asDiagonal();
  const Identifiability seen = identify(g, Eigen::Vector2d(2.0, 1.0), Eigen::Vector2d(0.5, 2.0));
  EXPECT_EQ(seen.rank, 2);
  EXPECT_DOUBLE_EQ(seen.singular_values(0), 6.0);  // 3 * 2 / 1
  EXPECT_DOUBLE_EQ(seen.singular_values(1), 1.0);  // 4 * 0.5 / 2
  EXPECT_TRUE(seen.unseen_directions.empty());
}

TEST(Identifiability, ParametersThatActOnlyTogetherLeaveTheirDifferenceUnseen) {
  Eigen::MatrixXd g(2, 2);
  g << 1.0, 1.0, 2.0, 2.0;
  const Identifiability seen = identify(g, Eigen::Vector2d::Ones(), Eigen::Vector2d::Ones());
  EXPECT_EQ(seen.rank, 1);
  ASSERT_EQ(seen.unseen_directions.size(), 1U);
  EXPECT_NEAR(seen.unseen_directions[0].sum(), 0.0, 1e-12);
}

TEST(Identifiability, MoreParametersThanOutputsLeaveTheRestUnseen) {
  const Identifiability seen =
      identify(Eigen::RowVector3d(1.0, 0.0, 0.0), Eigen::VectorXd::Ones(1), Eigen::Vector3d::Ones());
  EXPECT_EQ(seen.rank, 1);
  EXPECT_EQ(seen.unseen_directions.size(), 2U);
}

TEST(AutomaticSamples, GiveATenthOfTheTestsStandardErrorAtLeast) {
  EXPECT_GE(automatic_samples(10, 3, 0.05), 1000);
  EXPECT_GE(automatic_samples(100, 3, 0.05), 10000);
}

TEST(LargestMovement, IsMeasuredInPriorDeviations) {
  const Eigen::Vector2d before(1.0, 2.0);
  const Eigen::Vector2d after(1.1, 2.1);
  const Eigen::Matrix2d still = Eigen::Matrix2d::Identity();
  EXPECT_NEAR(largest_movement(Eigen::Vector2d(0.1, 1.0), before, still, after, still), 1.0, 1e-12);
  EXPECT_NEAR(largest_movement(Eigen::Vector2d(1.0, 0.5), before, still, before, 4.0 * still), 2.0, 1e-12);
}

TEST(IsStalled, OnlyWhenNoLaterMovementIsSmaller) {
  EXPECT_FALSE(is_stalled({1.0, 0.5, 0.4, 0.3}, 3));
  EXPECT_TRUE(is_stalled({1.0, 0.5, 0.7, 0.6, 0.8}, 3));
  EXPECT_FALSE(is_stalled({0.1, 0.2}, 3));
}

}  // namespace
}  // namespace mottle::updating
