#include "mottle/updating/diagnosis/diagnosis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "support/instrumented.hpp"
#include "support/linear_model.hpp"

namespace mottle::updating {
namespace {

using test::LinearModel;

/// y = x1 (1,0,0,0,0) + x2 (0,1,1,0,0) + x3 (0,0,1,1,0) + x4 (0,0,0,0,1): x1, x2 given, x3, x4 candidates at 0.
struct Bench {
  Bench() {
    slope.col(0) << 1.0, 0.0, 0.0, 0.0, 0.0;
    slope.col(1) << 0.0, 1.0, 1.0, 0.0, 0.0;
    slope.col(2) << 0.0, 0.0, 1.0, 1.0, 0.0;
    slope.col(3) << 0.0, 0.0, 0.0, 0.0, 1.0;
    model = std::make_unique<LinearModel>(Eigen::VectorXd::Zero(5), slope);
    std::vector<Parameter> parameters;
    for (const char* name : {"x1", "x2", "x3", "x4"}) {
      parameters.push_back({.name = name, .unit = "-", .limit = {-1e9, false}});
    }
    const Distribution prior({.kind = DistributionKind::normal, .mean = 0.0, .std = 1.0});
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution({prior, prior, prior, prior}));
  }

  /// Specimens with x1, x2 ~ N(0, 1), x3 = shift + scatter N(0, 1), noise 0.1.
  Eigen::MatrixXd tests(double shift, double scatter, Eigen::Index count = k_many, std::uint64_t seed = 3) const {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(count, 4);
    Eigen::MatrixXd e(count, 5);
    for (Eigen::Index s = 0; s < count; ++s) {
      RandomStream stream({.seed = seed, .purpose = StreamPurpose::truth}, static_cast<std::uint32_t>(s));
      const auto normal = [&] { return standard_normal_quantile(stream.uniform()); };
      x(s, 0) = normal();
      x(s, 1) = normal();
      x(s, 2) = shift + scatter * normal();
      for (Eigen::Index k = 0; k < 5; ++k) e(s, k) = k_noise * normal();
    }
    return x * slope.transpose() + e;
  }

  Diagnosis run(const Eigen::MatrixXd& values, DiagnosisSettings settings = {.given = 2},
                double known_noise = k_noise) const {
    const UpdatingProblem problem{
        .model = *model, .space = *space, .tests = {values, Eigen::VectorXd::Constant(values.cols(), known_noise)}};
    return diagnose(problem, settings, {});
  }

  /// Bounds one of the parameters.
  void bound(std::size_t which, double lower, double upper) {
    std::vector<Parameter> parameters = space->parameters();
    parameters[which].lower_bound = lower;
    parameters[which].upper_bound = upper;
    space = std::make_unique<ParameterSpace>(std::move(parameters), space->prior());
  }

  static constexpr Eigen::Index k_many = 32;  // so many that likelihood ratios need no replications
  static constexpr double k_noise = 0.1;
  Eigen::MatrixXd slope{5, 4};
  std::unique_ptr<LinearModel> model;
  std::unique_ptr<ParameterSpace> space;
};

TEST(Diagnosis, AShiftedCandidateIsNamedAndItsMeanFound) {
  const Diagnosis found = Bench().run(Bench().tests(0.5, 0.0));
  EXPECT_TRUE(found.is_explained);
  EXPECT_THAT(found.alike, testing::ElementsAre("x3"));
  EXPECT_FALSE(found.candidates[0].better().is_random);
  EXPECT_NEAR(found.candidates[0].better().mean, 0.5, 4.0 * 0.1 / std::sqrt(32.0));
  ASSERT_EQ(found.proposed.size(), 3U);
  EXPECT_EQ(found.proposed[2].name, "x3");
  EXPECT_FALSE(found.proposed[2].is_random);
}

/// With the noise known the gain of a shift is closed: only the candidate's part that the given parameters cannot
/// imitate counts, r = mean residual in the direction (0, -1/2, 1/2, 1, 0), 2 gain = n (r' z)^2 / (noise^2 |r|^2).
TEST(Diagnosis, TheGainOfAShiftIsTheGeneralisedLeastSquaresOne) {
  const Eigen::MatrixXd values = Bench().tests(0.1, 0.0);
  const Diagnosis found = Bench().run(values);
  Eigen::VectorXd direction(5);
  direction << 0.0, -0.5, 0.5, 1.0, 0.0;
  const Eigen::VectorXd mean = values.colwise().mean();
  const double along = direction.dot(mean);
  const double expected = 0.5 * 32.0 * along * along / (0.01 * direction.squaredNorm());
  for (const CandidateFinding& candidate : found.candidates) {
    if (candidate.detectability.name == "x3") {
      EXPECT_NEAR(candidate.fixed.log_likelihood_increase, expected, 1e-4 * expected);
    }
  }
}

TEST(Diagnosis, ACandidateThatScattersIsFreed) {
  const Diagnosis found = Bench().run(Bench().tests(0.0, 1.0));
  EXPECT_TRUE(found.is_explained);
  EXPECT_EQ(found.candidates[0].detectability.name, "x3");
  EXPECT_TRUE(found.candidates[0].better().is_random);
  EXPECT_NEAR(found.candidates[0].better().standard_deviation, 1.0, 0.5);
}

TEST(Diagnosis, WhereNothingIsMissingNothingIsAdded) {
  const Diagnosis found = Bench().run(Bench().tests(0.0, 0.0));
  EXPECT_FALSE(found.is_explained);
  EXPECT_EQ(found.proposed.size(), 2U);
  EXPECT_EQ(found.judging, 3);
  EXPECT_THAT(found.sentences.front(), testing::HasSubstr("No candidate explains"));
}

/// Replicated at three specimens with the noise unknown. 100 replications: 5 % have a standard error of 2.2 %.
TEST(Diagnosis, WithFewSpecimensAndUnknownNoiseNothingIsNamedOftenerThanTheLevel) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  const Bench bench;
  int named = 0;
  for (std::uint64_t seed = 100; seed < 200; ++seed) {
    named += bench.run(bench.tests(0.0, 0.0, 3, seed), {.given = 2}, 0.0).is_explained ? 1 : 0;
  }
  EXPECT_LE(named, 100 * (0.05 + 0.02 + 2.0 * 0.022));
}

TEST(Diagnosis, WithFewSpecimensALargeShiftIsStillNamed) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  const Bench bench;
  for (std::uint64_t seed = 100; seed < 106; ++seed) {
    const Diagnosis found = bench.run(bench.tests(2.0, 0.0, 4, seed), {.given = 2}, 0.0);
    EXPECT_TRUE(found.is_explained) << seed;
    EXPECT_EQ(found.candidates[0].detectability.name, "x3") << seed;
  }
}

TEST(Diagnosis, ReplicationsDoNotDependOnThreads) {
  const Bench bench;
  const UpdatingProblem problem{
      .model = *bench.model, .space = *bench.space, .tests = {bench.tests(1.0, 0.0, 4, 100), Eigen::VectorXd::Zero(5)}};
  const Diagnosis one = diagnose(problem, {.given = 2}, {.threads = 1});
  const Diagnosis three = diagnose(problem, {.given = 2}, {.threads = 3});
  for (std::size_t c = 0; c < one.candidates.size(); ++c) {
    EXPECT_EQ(one.candidates[c].fixed.p_value, three.candidates[c].fixed.p_value);
    EXPECT_EQ(one.candidates[c].random.adjusted_p, three.candidates[c].random.adjusted_p);
  }
}

TEST(Diagnosis, ScreeningInLinearModelsKeepsTheBestCandidate) {
  const Diagnosis found = Bench().run(Bench().tests(0.5, 0.0), {.given = 2, .screened = 1});
  EXPECT_EQ(found.candidates[0].detectability.name, "x3");
  EXPECT_TRUE(found.candidates[1].is_screened_out);
}

/// x4 moves the outputs as x3 does, and one output of its own that nothing explains, a hundred times less: in a linear
/// model it would explain more than x3, but only by fifty prior standard deviations.
TEST(Diagnosis, ScreeningCountsNoShiftThatIsFarBeyondThePrior) {
  Bench bench;
  bench.slope.col(3) = 0.01 * bench.slope.col(2);
  bench.slope(4, 3) = 0.002;
  bench.model = std::make_unique<LinearModel>(Eigen::VectorXd::Zero(5), bench.slope);
  Eigen::MatrixXd values = bench.tests(0.5, 0.0);
  values.col(4).array() += 0.1;
  const Diagnosis found = bench.run(values, {.given = 2, .screened = 1});
  EXPECT_EQ(found.candidates[0].detectability.name, "x3");
  EXPECT_TRUE(found.candidates[1].is_screened_out);
}

/// Two outputs and two parameters: whatever a third does to the mean, the two can do too.
TEST(Diagnosis, WithAsManyParametersAsOutputsCandidatesCannotBeToldApart) {
  Eigen::MatrixXd slope(2, 4);
  slope << 1.0, 0.2, 0.5, 0.7, 0.3, 1.0, 0.4, -0.6;
  Bench bench;
  bench.model = std::make_unique<LinearModel>(Eigen::VectorXd::Zero(2), slope);
  const Eigen::MatrixXd x = bench.tests(0.0, 0.0).leftCols(2);
  const Diagnosis found = bench.run(x * slope.leftCols(2).transpose());
  EXPECT_FALSE(found.is_explained);
  EXPECT_EQ(found.judging, 0);
  EXPECT_EQ(found.alike.size(), 2U);
  EXPECT_THAT(found.sentences[1], testing::HasSubstr("cannot distinguish"));
  for (const CandidateFinding& candidate : found.candidates) EXPECT_EQ(candidate.detectability.own_share, 0.0);
}

TEST(Diagnosis, TheSharesAreThoseOfTheWhitenedSensitivities) {
  const Diagnosis found = Bench().run(Bench().tests(0.0, 0.0));
  for (const CandidateFinding& candidate : found.candidates) {
    if (candidate.detectability.name == "x4") {
      EXPECT_NEAR(candidate.detectability.visibility, std::sqrt(32.0) / 0.1, 1e-6 * std::sqrt(32.0) / 0.1);
      EXPECT_NEAR(candidate.detectability.own_share, 1.0, 1e-9);
    }
  }
}

/// The outputs are linear, so what the linear answer says is what the fits find.
TEST(Diagnosis, TheLinearAnswerIsKnownBeforeAnyFitAndIsThatOfALinearModel) {
  const Bench bench;
  const UpdatingProblem problem{.model = *bench.model,
                                .space = *bench.space,
                                .tests = {bench.tests(0.5, 0.0), Eigen::VectorXd::Constant(5, Bench::k_noise)}};
  Diagnosis linear;
  std::int64_t runs = 0;
  const Diagnosis found = diagnose(problem, {.given = 2}, {}, [&](const Diagnosis& answer) {
    linear = answer;
    runs = bench.model->runs;
  });
  EXPECT_TRUE(linear.is_linear);
  EXPECT_TRUE(linear.is_explained);
  EXPECT_LT(runs, bench.model->runs / 2);
  EXPECT_EQ(linear.candidates[0].detectability.name, "x3");
  EXPECT_FALSE(linear.candidates[0].is_fitted());
  EXPECT_THAT(diagnosis_headline(linear, 0.05), testing::StartsWith("Linear answer: x3 explains the tests best"));
  const double fitted = found.candidates[0].fixed.log_likelihood_increase;
  EXPECT_NEAR(linear.candidates[0].linear.log_likelihood_increase, fitted, 1e-3 * fitted);
  EXPECT_NEAR(linear.candidates[0].linear.mean, found.candidates[0].fixed.mean, 1e-3);
}

/// In standard errors of the tests' mean, which is 0.5 off in outputs 3 and 4; the parameters take up part of output 3.
TEST(Diagnosis, TheBestCandidateTakesTheResidualsAway) {
  const Diagnosis found = Bench().run(Bench().tests(0.5, 0.0));
  EXPECT_GT(found.residuals.cwiseAbs().maxCoeff(), 3.0);
  EXPECT_LT(found.candidates[0].better().residuals.cwiseAbs().maxCoeff(), 2.0);
}

/// The tests ask for 0.5, and the candidate may be 0.1 at most.
TEST(Diagnosis, AValueThatCannotBeIsSaidAndRankedBehindWhatCanBe) {
  Bench bench;
  bench.bound(2, -1.0, 0.1);
  Eigen::MatrixXd values = bench.tests(0.5, 0.0);
  values.col(4).array() += 0.05;
  const Diagnosis found = bench.run(values);
  EXPECT_EQ(found.candidates[0].detectability.name, "x4");
  const CandidateFit& fit = found.candidates[1].better();
  EXPECT_FALSE(fit.is_possible);
  EXPECT_LT(fit.bic, found.candidates[0].bic());  // even so it would explain more
  EXPECT_NEAR(fit.mean, 0.1, 1e-6);
  EXPECT_NEAR(fit.needed, 0.5, 4.0 * 0.1 / std::sqrt(32.0));
  EXPECT_THAT(found.sentences, testing::Contains(testing::HasSubstr("x3 would need")));
  for (const ProposedParameter& proposed : found.proposed) EXPECT_NE(proposed.name, "x3");
}

/// A spring that is not there: its estimate ends on its limit as often as not, by the error of the tests.
TEST(Diagnosis, AnEstimateThatIsOnALimitByTheErrorOfTheTestsIsPossible) {
  int beyond = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Bench bench;
    bench.bound(2, 0.0, 10.0);
    const Diagnosis found = bench.run(bench.tests(0.0, 0.0, Bench::k_many, seed));
    for (const CandidateFinding& candidate : found.candidates) {
      if (candidate.detectability.name != "x3") continue;
      EXPECT_GE(candidate.fixed.mean, 0.0);
      beyond += candidate.fixed.is_possible ? 0 : 1;
    }
  }
  EXPECT_LE(beyond, 2);  // at a level of 5 %, one-sided: 0.3 of 12
}

/// x4 moves the outputs as x3 does, but for output 5: by an angle whose tangent is tilt / |(0, -1/2, 1/2, 1, 0)|.
Bench tilted(double degrees) {
  Bench bench;
  bench.slope.col(3) = bench.slope.col(2);
  bench.slope(4, 3) = std::sqrt(1.5) * std::tan(degrees * std::numbers::pi / 180.0);
  bench.model = std::make_unique<LinearModel>(Eigen::VectorXd::Zero(5), bench.slope);
  return bench;
}

TEST(Diagnosis, CandidatesOfOneDirectionAreNamedTogetherAndOnlyOneIsFittedWhereFitsAreFew) {
  const Bench bench = tilted(1.0);
  const Diagnosis found = bench.run(bench.tests(0.5, 0.0), {.given = 2, .screened = 1});
  EXPECT_THAT(found.alike, testing::UnorderedElementsAre("x3", "x4"));
  EXPECT_THAT(found.candidates[0].inseparable, testing::ElementsAre(found.candidates[1].detectability.name));
  EXPECT_FALSE(found.candidates[1].is_fitted());
  EXPECT_THAT(found.candidates[1].better().failure, testing::HasSubstr("cannot be told apart"));
  EXPECT_THAT(found.sentences, testing::Contains(testing::HasSubstr("cannot be told apart")));
}

TEST(Diagnosis, CandidatesThatFormALargerAngleAreToldApart) {
  const Bench bench = tilted(8.0);
  const Diagnosis found = bench.run(bench.tests(0.5, 0.0));
  for (const CandidateFinding& candidate : found.candidates) EXPECT_TRUE(candidate.inseparable.empty());
  EXPECT_THAT(found.alike, testing::ElementsAre("x3"));
}

TEST(Diagnosis, AThoroughOneFitsEveryCandidate) {
  const Diagnosis found = Bench().run(Bench().tests(0.5, 0.0), {.given = 2, .screened = 1, .fits_all = true});
  for (const CandidateFinding& candidate : found.candidates) EXPECT_TRUE(candidate.is_fitted());
}

TEST(Diagnosis, RefusesWhatItCannotJudge) {
  EXPECT_THROW(Bench().run(Bench().tests(0.0, 0.0), {.given = 4}), InvalidInput);
  EXPECT_THROW(Bench().run(Bench().tests(0.0, 0.0).topRows(2)), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
