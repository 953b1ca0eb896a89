#include "mottle/updating/methods/interval.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "support/linear_model.hpp"
#include "support/methods.hpp"
#include "support/parameter_pencils.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using Bounds = IntervalOptions::Bounds;
constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

UpdatingResult update(const UpdatingProblem& problem, const IntervalOptions& options, const RunContext& context = {}) {
  return IntervalUpdater(options).update(problem, context);
}

std::string refusal(const UpdatingProblem& problem, const IntervalOptions& options) {
  try {
    update(problem, options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

bool warns(const UpdatingResult& result, const std::string& words) {
  return std::ranges::any_of(result.warnings, [&](const auto& text) { return text.find(words) != std::string::npos; });
}

/// y = a + G x with normal priors of mean 0 and deviation 1.
struct Linear {
  Linear(const Eigen::MatrixXd& slope, const Eigen::MatrixXd& specimens, double bound = 100.0)
      : model(Eigen::VectorXd::Zero(slope.rows()), slope), tests(specimens) {
    std::vector<Parameter> parameters;
    std::vector<Distribution> priors;
    for (Eigen::Index i = 0; i < slope.cols(); ++i) {
      parameters.push_back({fmt::format("x{}", i + 1), "-", -bound, bound, {-1e9, false}});
      priors.emplace_back(DistributionSpec{.kind = DistributionKind::normal, .mean = 0.0, .std = 1.0});
    }
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution(priors));
  }
  UpdatingProblem problem(double noise = 0.0) const {
    return {.model = model,
            .space = *space,
            .tests = {tests, Eigen::VectorXd::Constant(tests.cols(), noise)},
            .cloud = {.samples = 50}};
  }
  test::LinearModel model;
  Eigen::MatrixXd tests;
  std::unique_ptr<ParameterSpace> space;
};

TEST(Interval, EqualsTheBoundsOfTestsThatMeasureTheParameter) {
  const Linear one(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::Vector3d(1.0, 4.0, 2.0));
  const UpdatingResult result = update(one.problem(), {.bounds = Bounds::observed});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  ASSERT_TRUE(result.interval);
  EXPECT_NEAR(result.interval->box.lower(0), 0.5, 1e-6);
  EXPECT_NEAR(result.interval->box.upper(0), 2.0, 1e-6);
  EXPECT_LE(result.interval->image[0].lower, 1.0);  // covered in floating point
  EXPECT_GE(result.interval->image[0].upper, 4.0);
}

TEST(Interval, IsMeanAndDeviationForNormalLimits) {
  const Linear one(Eigen::MatrixXd::Ones(1, 1), (Eigen::VectorXd(5) << 1.0, 2.0, 3.0, 4.0, 5.0).finished());
  const UpdatingResult result = update(one.problem(), {});
  const double reach = 5.076874532061071 * std::sqrt(2.5);
  EXPECT_NEAR(result.interval->box.lower(0), 3.0 - reach, 1e-5);
  EXPECT_NEAR(result.interval->box.upper(0), 3.0 + reach, 1e-5);
}

/// Radii r of the box are the solution of the linear programme min sum r, |G| r >= radii of the tests, here in the
/// corner where both hold: r = |G|^-1 (1, 1.2) = (0.4, 0.2).
TEST(Interval, SolvesTheLinearProgrammeOfALinearModel) {
  const Eigen::Matrix2d slope = (Eigen::Matrix2d() << 2.0, 1.0, 1.0, -4.0).finished();
  const Eigen::Vector2d radius(1.0, 1.2), middle(3.0, -1.0);
  Eigen::MatrixXd tests(2, 2);
  tests << (middle - radius).transpose(), (middle + radius).transpose();
  const Linear two(slope, tests);
  const UpdatingResult result = update(two.problem(), {.bounds = Bounds::observed});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_LT((0.5 * result.interval->box.width() - slope.cwiseAbs().inverse() * radius).norm(), 1e-5);
  EXPECT_LT((result.mean - slope.inverse() * middle).norm(), 1e-5);
  EXPECT_NEAR(result.interval->measure, 2.0 * (0.4 + 0.2), 1e-5);
  EXPECT_TRUE(result.interval->undetermined.empty());
}

/// Specimens of which two are the corners where all stiffnesses are lowest and highest: the bounds are exact.
Eigen::MatrixXd corner_specimens(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  Eigen::MatrixXd x(4, 3);
  x << lower.transpose(), upper.transpose(), lower(0), upper(1), lower(2), upper(0), lower(1), upper(2);
  return x;
}

TEST(Interval, RecoversTheBoxOfThreeMassesFromExactBounds) {
  const Eigen::Vector3d lower(0.9, 1.1, 1.3), upper(1.2, 1.7, 1.6);
  const test::ThreeMasses structure;
  const Eigen::MatrixXd tests = test::frequencies_of(structure, corner_specimens(lower, upper));
  const UpdatingResult result = update(structure.problem(tests), {.bounds = Bounds::observed});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_LT((result.interval->box.lower - lower).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((result.interval->box.upper - upper).cwiseAbs().maxCoeff(), 1e-5);
  for (std::size_t k = 0; k < 3; ++k) {
    const OutputRange& range = result.interval->image[k];
    EXPECT_TRUE(range.is_certified);
    EXPECT_LE(range.proven_lower, range.lower);
    EXPECT_GE(range.proven_upper, range.upper);
    EXPECT_GE(result.interval->excess.row(static_cast<Eigen::Index>(k)).minCoeff(), 0.0);
  }
  EXPECT_THAT(result.interval->trends, testing::Each("rising"));
  EXPECT_TRUE(warns(result, "observed bounds alone"));
}

TEST(Interval, FindsTheSameBoxByLooking) {
  const Eigen::Vector3d lower(0.9, 1.1, 1.3), upper(1.2, 1.7, 1.6);
  const test::ThreeMasses structure;
  const Eigen::MatrixXd tests = test::frequencies_of(structure, corner_specimens(lower, upper));
  UpdatingProblem problem = structure.problem(tests);
  problem.derivatives = nullptr;  // as of a program's model
  const UpdatingResult result = update(problem, {.bounds = Bounds::observed, .search_points = 20});
  EXPECT_LT((result.interval->box.lower - lower).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((result.interval->box.upper - upper).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_FALSE(result.interval->image[0].is_certified);
  EXPECT_TRUE(std::isnan(result.interval->image[0].proven_lower));
  EXPECT_TRUE(test::says(result, "searched for and is not proven"));
}

/// lambda_1 of a single mass whose parameter t stands in stiffness and mass: (1 + 2 t^3) / (1 + t).
TEST(Interval, CoversWithAParameterThatIsNotMonotone) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const auto model =
      test::model_of({{{}, one}, {{{0, 3}}, 2.0 * one}}, {{{}, one}, {{{0, 1}}, one}}, Eigen::VectorXd::Ones(1), {1});
  const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.2});
  const ParameterSpace space({{"t", "-", 0.1, 2.0, {}}}, JointDistribution({prior}));
  const Eigen::Vector2d tests(0.9, 2.0);  // t = 0.7095 and 1.1654 where it rises
  const UpdatingProblem problem{.model = *model,
                                .derivatives = model.get(),
                                .space = space,
                                .tests = {tests, Eigen::VectorXd::Zero(1)},
                                .cloud = {.samples = 20}};
  const UpdatingResult result = update(problem, {.bounds = Bounds::observed});
  ASSERT_TRUE(result.interval);
  const auto lambda = [](double t) { return (1.0 + 2.0 * t * t * t) / (1.0 + t); };
  EXPECT_NEAR(lambda(result.interval->box.lower(0)), 0.9, 1e-5);
  EXPECT_NEAR(lambda(result.interval->box.upper(0)), 2.0, 1e-5);
  EXPECT_EQ(result.interval->trends.front(), "mixed");
  EXPECT_TRUE(result.interval->image[0].is_certified);
}

TEST(Interval, SaysWhichBoundsNoBoxCovers) {
  Eigen::MatrixXd slope(2, 1);
  slope << 1.0, 0.01;  // the second output differs by far more than the parameter can make it
  Eigen::MatrixXd tests(3, 2);
  tests << 1.0, 5.0, 2.0, 3.0, 3.0, -1.0;
  const Linear model(slope, tests, 4.0);
  UpdatingProblem problem = model.problem(0.01);
  const UpdatingResult result = update(problem, {.bounds = Bounds::observed});
  EXPECT_NEAR(result.interval->box.lower(0), 1.0, 1e-5);  // by the first output
  EXPECT_NEAR(result.interval->box.upper(0), 3.0, 1e-5);
  EXPECT_NEAR(result.interval->excess(1, 1), 0.03 - 5.0, 1e-5);
  EXPECT_TRUE(warns(result, "Within the bounds of the parameters the parameters move y2 (0.08 of 6 "));
  EXPECT_FALSE(warns(result, "No box within"));
  EXPECT_EQ(judge(problem, result).conclusion, Conclusion::inadequate);
}

TEST(Interval, CoversWhatItsBoundsLet) {
  const Linear model(Eigen::MatrixXd::Ones(1, 1), Eigen::Vector3d(1.0, 2.0, 3.0), 2.5);
  const UpdatingResult result = update(model.problem(0.01), {.bounds = Bounds::observed});
  EXPECT_NEAR(result.interval->box.lower(0), 1.0, 1e-5);
  EXPECT_NEAR(result.interval->box.upper(0), 2.5, 1e-5);
  EXPECT_NEAR(result.interval->excess(0, 1), -0.5, 1e-5);
}

TEST(Interval, TakesTheWholeAllowedBoxWhereAllTestsAreWider) {
  const Eigen::Matrix2d slope = (Eigen::Matrix2d() << 1.0, 0.5, 0.5, -1.0).finished();
  Eigen::MatrixXd tests(3, 2);
  tests << -2.0, 1.0, 0.5, -1.5, 2.0, 0.0;
  const Linear model(slope, tests, 0.1);
  const UpdatingResult result = update(model.problem(0.01), {.bounds = Bounds::observed});
  EXPECT_LT((result.interval->box.lower.array() + 0.1).abs().maxCoeff(), 1e-5);
  EXPECT_LT((result.interval->box.upper.array() - 0.1).abs().maxCoeff(), 1e-5);
  EXPECT_TRUE(warns(result, "No box within the bounds of the parameters covers y1"));
  EXPECT_FALSE(warns(result, "was not asked to"));
  EXPECT_FALSE(warns(result, "no width"));
}

TEST(Interval, NamesItsOwnLimitsAsSuch) {
  const Linear model(Eigen::MatrixXd::Ones(1, 1), Eigen::Vector3d(0.0, 1.0, 3.0), 1e6);
  const UpdatingResult result = update(model.problem(0.01), {});
  EXPECT_NEAR(result.interval->box.upper(0), 13.0, 1e-3);  // ten prior deviations beyond the last specimen
  EXPECT_TRUE(warns(result, "No box within 10 prior standard deviations of x1 about prior and specimens"));
  EXPECT_NEAR(result.interval->box.lower(0), -10.0, 1e-3);
  EXPECT_TRUE(warns(result, "give a wider distribution to x1"));
}

TEST(Interval, LooksForNoBoxOfParametersWithoutEffect) {
  const Linear model(Eigen::MatrixXd::Zero(1, 1), Eigen::Vector3d(-1.0, 0.0, 1.0));
  const UpdatingResult result = update(model.problem(0.01), {});
  EXPECT_EQ(result.status, UpdatingStatus::stalled);
  EXPECT_THAT(result.message, testing::HasSubstr("no box was looked for"));
}

TEST(Interval, IsNoComfortWithoutFurtherOutputs) {
  const Linear model(Eigen::MatrixXd::Ones(1, 1), Eigen::Vector3d(1.0, 2.0, 3.0));
  const UpdatingProblem problem = model.problem(0.01);
  const Verdict verdict = judge(problem, update(problem, {}));
  EXPECT_EQ(verdict.conclusion, Conclusion::undecided);
  EXPECT_TRUE(verdict.lacks_outputs);
}

TEST(Interval, RefusesAModelThatNoSpecimenFits) {
  const Eigen::MatrixXd slope = (Eigen::MatrixXd(3, 1) << 1.0, 1.0, 2.0).finished();
  Eigen::MatrixXd right(4, 3), wrong(4, 3);
  for (int s = 0; s < 4; ++s) {
    right.row(s) = (1.0 + 0.3 * s) * slope.transpose() + 0.01 * Eigen::RowVector3d(s % 2, (s + 1) % 2, -(s % 2));
    wrong.row(s) = right.row(s) + Eigen::RowVector3d(0.2, 0.0, 0.0);
  }
  const Linear good(slope, right), bad(slope, wrong);
  EXPECT_EQ(judge(good.problem(0.02), update(good.problem(0.02), {})).conclusion, Conclusion::adequate);
  EXPECT_EQ(judge(bad.problem(0.02), update(bad.problem(0.02), {})).conclusion, Conclusion::inadequate);
}

/// y_k = x, the third specimen's own x 0.1 beyond the bound: ten standard deviations of the noise, of which a box
/// within the bound falls short, but no error of the model.
TEST(Interval, JudgesNoSpecimenBeyondTheBoundsByTheirDistance) {
  const Linear three(Eigen::MatrixXd::Ones(3, 1), Eigen::Vector3d(0.2, 0.5, 1.1).replicate(1, 3), 1.0);
  const UpdatingResult result = update(three.problem(0.01), {.bounds = Bounds::observed});
  for (const VerdictTest& test : result.tests) EXPECT_EQ(test.passed, test.name != "cover") << test.name;
}

TEST(Interval, TellsOfAParameterThatTheBoundsDoNotNeed) {
  const Linear model(Eigen::RowVector2d(1.0, 0.5), Eigen::Vector3d(1.0, 2.0, 3.0));
  const UpdatingResult result = update(model.problem(), {.bounds = Bounds::observed});
  EXPECT_NEAR(result.interval->measure, 2.0, 1e-5);  // all by x1, which is cheaper
  EXPECT_THAT(result.interval->undetermined, testing::Contains(testing::HasSubstr("x2 has no width")));
}

TEST(Interval, NamesSpecimensWhoseOwnParametersAreOutside) {
  // y1 = x1 + x2, y2 = x1 - x2; the specimens lie on the axes, where both outputs are less extreme than in corners.
  Eigen::MatrixXd x(4, 2);
  x << 1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0;
  const Eigen::Matrix2d slope = (Eigen::Matrix2d() << 1.0, 1.0, 1.0, -1.0).finished();
  const Linear model(slope, x * slope.transpose());
  const UpdatingResult result = update(model.problem(), {.bounds = Bounds::observed});
  EXPECT_NEAR(result.interval->measure, 2.0, 1e-4);  // radii of sum 1 are enough; the hull has 1 each
  EXPECT_LT((result.interval->hull.upper - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-4);
  EXPECT_FALSE(result.interval->outside.empty());
  EXPECT_TRUE(warns(result, "lie outside the box"));
}

TEST(Interval, RefusesTestsThatHaveNoBounds) {
  const Eigen::MatrixXd slope = Eigen::MatrixXd::Ones(2, 1);
  EXPECT_THAT(refusal(Linear(slope, Eigen::RowVector2d(1.0, 1.0)).problem(), {}),
              testing::HasSubstr("1 specimen has no bounds"));
  Eigen::MatrixXd gaps(3, 2);
  gaps << 1.0, 1.0, 2.0, k_nan, 3.0, k_nan;
  EXPECT_THAT(refusal(Linear(slope, gaps).problem(), {}), testing::HasSubstr("y2 was measured on 1 specimens"));
  EXPECT_THAT(refusal(Linear(slope, Eigen::MatrixXd::Random(30, 2)).problem(), {.bounds = Bounds::distribution_free}),
              testing::HasSubstr("need 93 specimens"));
}

TEST(Interval, RefusesAFrequencyWhoseLowerLimitIsNegative) {
  const test::ThreeMasses structure;
  const Eigen::MatrixXd tests =
      test::frequencies_of(structure, corner_specimens(Eigen::Vector3d::Constant(0.8), Eigen::Vector3d::Constant(1.2)));
  EXPECT_THAT(refusal(structure.problem(tests.topRows(2)), {}), testing::HasSubstr("lower tolerance limit of f1"));
  EXPECT_EQ(refusal(structure.problem(tests.topRows(2)), {.bounds = Bounds::observed}), "");
}

TEST(Interval, TakesDistributionFreeLimitsOfEnoughSpecimens) {
  Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(93, 1.0, 2.0);
  const Linear model(Eigen::MatrixXd::Ones(1, 1), values);
  const UpdatingResult result = update(model.problem(), {.bounds = Bounds::distribution_free});
  EXPECT_NEAR(result.interval->box.upper(0), 2.0, 1e-6);
  EXPECT_GE(result.interval->tests.content(0), 0.95);
}

TEST(Interval, WarnsOfOutputsWithoutWidth) {
  Eigen::MatrixXd tests(3, 2);
  tests << 1.0, 2.0, 2.0, 2.0, 3.0, 2.0;
  const Linear model((Eigen::Matrix2d() << 1.0, 0.0, 0.0, 1.0).finished(), tests);
  const UpdatingResult result = update(model.problem(), {});
  EXPECT_NEAR(result.interval->box.lower(1), 2.0, 1e-5);
  EXPECT_NEAR(result.interval->box.upper(1), 2.0, 1e-5);
  EXPECT_TRUE(warns(result, "All tests of y2 are equal"));
}

TEST(Interval, UsesWhatWasMeasured) {
  Eigen::MatrixXd tests(4, 2);
  tests << 1.0, k_nan, 2.0, 4.0, k_nan, 8.0, 3.0, 6.0;
  const Linear model((Eigen::Matrix2d() << 1.0, 0.0, 0.0, 1.0).finished(), tests);
  const UpdatingResult result = update(model.problem(), {.bounds = Bounds::observed});
  EXPECT_LT((result.interval->box.lower - Eigen::Vector2d(1.0, 4.0)).norm(), 1e-5);
  EXPECT_LT((result.interval->box.upper - Eigen::Vector2d(3.0, 8.0)).norm(), 1e-5);
}

TEST(Interval, DoesNotDependOnUnits) {
  const Eigen::Vector3d lower(0.9, 1.1, 1.3), upper(1.2, 1.7, 1.6);
  const test::ThreeMasses structure;
  const Eigen::MatrixXd tests = test::frequencies_of(structure, corner_specimens(lower, upper));
  const UpdatingResult plain = update(structure.problem(tests), {});
  constexpr double k_stiffer = 1e9;  // of springs and masses: frequencies stay
  const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}, {"k5", {"spring:k5"}}};
  MassSpringSystem system = test::three_mass_system();
  for (auto& mass : system.masses) mass.mass *= k_stiffer;
  for (auto& spring : system.springs) spring.value *= k_stiffer;
  std::vector<Parameter> parameters;
  for (const auto& target : targets) {
    parameters.push_back({target.parameter, "N/m", 0.5 * k_stiffer, 3.0 * k_stiffer, {}});
  }
  const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0 * k_stiffer, .std = 0.3 * k_stiffer});
  const ParameterSpace space(parameters, JointDistribution({prior, prior, prior}));
  const StructureModel model(separate(system, targets), OutputSelection{.frequencies = {1, 2, 3}},
                             Eigen::VectorXd::Constant(3, 2.0 * k_stiffer));
  const UpdatingProblem problem{
      .model = model, .derivatives = &model, .space = space, .tests = {tests, Eigen::VectorXd::Zero(3)}};
  const UpdatingResult scaled = update(problem, {});
  EXPECT_LT((scaled.interval->box.lower / k_stiffer - plain.interval->box.lower).norm(), 1e-6);
  EXPECT_LT((scaled.interval->box.upper / k_stiffer - plain.interval->box.upper).norm(), 1e-6);
}

}  // namespace
}  // namespace mottle::updating
