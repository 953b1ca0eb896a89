#include "mottle/updating/methods/deterministic.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/model/function_model.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using Regularisation = DeterministicOptions::Regularisation;
using test::frequencies_of;
using test::oracle_parameters;
using test::ThreeMasses;

/// Two parameters with prior N((1, 2), diag(0.2, 0.5)^2), outputs y = a + G x, in closed form throughout.
struct LinearCase {
  LinearCase() : model(Eigen::Vector3d(1.0, 0.0, 2.0), slope()) {
    const Distribution first({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.2});
    const Distribution second({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.5});
    space = std::make_unique<ParameterSpace>(
        std::vector<Parameter>{{"a", "-", -10.0, 10.0, limit()}, {"b", "-", -10.0, 10.0, limit()}},
        JointDistribution({first, second}));
  }
  static PhysicalLimit limit() { return {.lower = -1e9, .excludes_lower = false}; }
  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(3, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7;
    return g;
  }
  UpdatingProblem problem() const {
    Eigen::MatrixXd tests(1, 3);
    tests << 3.0, 2.5, 4.4;
    return {.model = model,
            .space = *space,
            .tests = {tests, Eigen::Vector3d(0.1, 0.2, 0.05)},
            .cloud = {.samples = 50},
            .tolerance = 1e-10};
  }
  /// (G'WG + Q)^-1 (G'W (z - a) + Q x0)
  static Eigen::Vector2d solution(const Eigen::Matrix2d& q) {
    const Eigen::Vector3d weight = Eigen::Vector3d(0.1, 0.2, 0.05).cwiseAbs2().cwiseInverse();
    const Eigen::MatrixXd gw = slope().transpose() * weight.asDiagonal();
    const Eigen::Matrix2d hessian = gw * slope() + q;
    const Eigen::Vector2d right = gw * (Eigen::Vector3d(3.0, 2.5, 4.4) - Eigen::Vector3d(1.0, 0.0, 2.0));
    return hessian.inverse() * (right + q * Eigen::Vector2d(1.0, 2.0));
  }
  test::LinearModel model;
  std::unique_ptr<ParameterSpace> space;
};

UpdatingResult update(const UpdatingProblem& problem, const DeterministicOptions& options) {
  return DeterministicUpdater(options).update(problem, {});
}

TEST(Deterministic, WithoutRegularisationItSolvesTheMeanOfTheTests) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-10;
  const UpdatingResult result = update(problem, {.regularisation = Regularisation::none});
  EXPECT_EQ(result.status, UpdatingStatus::converged);
  // validation/reference-rows, first order: f(mu) = z, given to eight digits.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.09877159, 1.05074330, 0.96464297)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Deterministic, BayesianRegularisationOfALinearModelIsItsPosterior) {
  const LinearCase linear;
  const Eigen::Matrix2d q = Eigen::Vector2d(1.0 / 0.04, 1.0 / 0.25).asDiagonal();
  const UpdatingResult result = update(linear.problem(), {.regularisation = Regularisation::bayesian});
  // Central differences of a linear function are exact to rounding over the step.
  EXPECT_LT((result.mean - LinearCase::solution(q)).cwiseAbs().maxCoeff(), 1e-8);
  const Eigen::Vector3d weight = Eigen::Vector3d(0.1, 0.2, 0.05).cwiseAbs2().cwiseInverse();
  const Eigen::Matrix2d posterior =
      (LinearCase::slope().transpose() * weight.asDiagonal() * LinearCase::slope() + q).inverse();
  EXPECT_LT((result.covariance - posterior).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Deterministic, TikhonovRegularisationOfALinearModelIsItsRidgeSolution) {
  const LinearCase linear;
  const Eigen::Matrix2d q = 9.0 * Eigen::Vector2d(1.0 / 0.04, 1.0 / 0.25).asDiagonal().toDenseMatrix();
  const UpdatingResult result =
      update(linear.problem(), {.regularisation = Regularisation::tikhonov, .tikhonov_parameter = 3.0});
  EXPECT_LT((result.mean - LinearCase::solution(q)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Deterministic, ABoundThatHoldsOneParameterLeavesTheOtherOptimalOnIt) {
  const LinearCase linear;
  const Distribution first({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.2});
  const Distribution second({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.5});
  const ParameterSpace bounded(
      {{"a", "-", 0.9, 1.1, LinearCase::limit()}, {"b", "-", -10.0, 10.0, LinearCase::limit()}},
      JointDistribution({first, second}));
  UpdatingProblem problem = linear.problem();
  const UpdatingProblem held{.model = problem.model,
                             .space = bounded,
                             .tests = problem.tests,
                             .cloud = problem.cloud,
                             .iterations = 100,
                             .tolerance = 1e-10};
  const UpdatingResult result = update(held, {.regularisation = Regularisation::none});
  ASSERT_EQ(bounded.active_bounds(result.mean)(0), 1);
  // With a = 1.1 held, b solves the one-parameter least squares.
  const Eigen::Vector3d weight = Eigen::Vector3d(0.1, 0.2, 0.05).cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd g = LinearCase::slope();
  const Eigen::Vector3d rest = Eigen::Vector3d(2.0, 2.5, 2.4) - 1.1 * g.col(0);
  const double b = g.col(1).dot(weight.cwiseProduct(rest)) / g.col(1).dot(weight.cwiseProduct(g.col(1)));
  EXPECT_NEAR(result.mean(1), b, 1e-8);
}

TEST(Deterministic, OneChosenSpecimenIsReproduced) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-10;
  for (const int specimen : {1, 10}) {
    const UpdatingResult result = update(problem, {.regularisation = Regularisation::none, .specimen = specimen});
    // Frequencies of three springs have several solutions; the one found must give the specimen's frequencies.
    const Eigen::MatrixXd frequencies = frequencies_of(structure, result.mean.transpose());
    EXPECT_LT((frequencies.row(0) - problem.tests.values.row(specimen - 1)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

/// y = (cos x, sin x, x / 20): on x = x* + 2 pi the first two are the same, and the third tells them apart.
struct Spiral {
  Spiral() : model(1, {named_quantity("c", "-"), named_quantity("s", "-"), named_quantity("t", "-")}, spiral) {}

  static Eigen::VectorXd spiral(const Eigen::VectorXd& x) {
    return Eigen::Vector3d(std::cos(x(0)), std::sin(x(0)), x(0) / 20.0);
  }
  UpdatingResult update_to(double x, double noise, int starts) const {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 0.7, .std = 3.0});
    const ParameterSpace space({{"x", "-", -20.0, 20.0, {.lower = -1e9, .excludes_lower = false}}},
                               JointDistribution({prior}));
    const Eigen::MatrixXd tests = spiral(Eigen::VectorXd::Constant(1, x)).transpose();
    const UpdatingProblem problem{.model = model,
                                  .space = space,
                                  .tests = {tests, Eigen::Vector3d::Constant(noise)},
                                  .cloud = {.samples = 50},
                                  .iterations = 50,
                                  .tolerance = 1e-8,
                                  .starts = starts};
    return update(problem, {.regularisation = Regularisation::none});
  }
  FunctionModel model;
};

TEST(Deterministic, TheLowestMinimumIsTheEstimateThoughTheStartLeadsToAnother) {
  // From 0.7 the nearest minimum is near 0.72, where t is off by 2 pi / 20 = 0.31, 31 standard deviations.
  const UpdatingResult result = Spiral().update_to(7.0, 0.01, 64);
  EXPECT_NEAR(result.mean(0), 7.0, 1e-6);
  EXPECT_EQ(result.status, UpdatingStatus::converged);
  EXPECT_TRUE(result.other_solutions.empty());
}

TEST(Deterministic, AMinimumThatFitsAsWellIsAnotherSolution) {
  // With a standard deviation of 1 the third output does not tell 0.72 from 7.
  const UpdatingResult result = Spiral().update_to(7.0, 1.0, 64);
  double weights = 0.0;
  bool has_near = std::abs(result.mean(0) - 7.0) < 0.1;
  for (const OtherSolution& other : result.other_solutions) {
    weights += other.weight;
    has_near = has_near || std::abs(other.mean(0) - 7.0) < 0.1;
  }
  EXPECT_GE(result.other_solutions.size(), 2U);  // 2 pi apart
  EXPECT_TRUE(has_near);
  EXPECT_LT(weights, 1.0);
  EXPECT_GT(weights, 0.5);  // none of them fits much better
}

TEST(Deterministic, TheLowestMinimumHasNoOtherSolution) {
  const UpdatingResult result = Spiral().update_to(0.5, 0.01, 64);
  EXPECT_NEAR(result.mean(0), 0.5, 1e-6);
  EXPECT_TRUE(result.other_solutions.empty());
}

TEST(Deterministic, WithoutStartsNoOtherMinimumIsLookedFor) {
  const UpdatingResult result = Spiral().update_to(7.0, 0.01, 0);
  EXPECT_NEAR(result.mean(0), 7.0 - 2.0 * std::numbers::pi, 0.02);
  ASSERT_TRUE(result.search);
  EXPECT_EQ(result.search->starts, 0);
}

TEST(Deterministic, ASpecimenIsChosenByTheNumberThatItsReaderKnows) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()).topRows(3));
  problem.tests.numbers = {1, 4, 5};
  problem.tolerance = 1e-10;
  const UpdatingResult result = update(problem, {.regularisation = Regularisation::none, .specimen = 4});
  const Eigen::MatrixXd frequencies = frequencies_of(structure, result.mean.transpose());
  EXPECT_LT((frequencies.row(0) - problem.tests.values.row(1)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_THROW(update(problem, {.specimen = 2}), InvalidInput);
}

TEST(Deterministic, DifferencesAgreeWithAnalyticSensitivities) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  const Eigen::Vector3d x(1.3, 0.9, 1.1);
  std::int64_t runs = 0;
  const Eigen::MatrixXd analytic = model_jacobian(problem, x, Eigen::Vector3d::Constant(0.3), {}, runs);
  EXPECT_EQ(runs, 0);
  problem.derivatives = nullptr;
  const Eigen::MatrixXd differences = model_jacobian(problem, x, Eigen::Vector3d::Constant(0.3), {}, runs);
  EXPECT_EQ(runs, 6);
  // Central differences with a step of 3e-5: truncation about 1e-10, rounding about 1e-11.
  EXPECT_LT((analytic - differences).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Deterministic, ResidualsBeyondTheMeasurementErrorFailTheChiSquaredTest) {
  const LinearCase linear;
  UpdatingProblem problem = linear.problem();
  EXPECT_TRUE(update(problem, {.regularisation = Regularisation::none}).tests.front().p_value >= 0.0);
  UpdatingProblem precise = linear.problem();
  precise.tests.repeatability_std *= 1e-3;
  const UpdatingResult result = update(precise, {.regularisation = Regularisation::none});
  ASSERT_EQ(result.tests.size(), 1U);
  EXPECT_FALSE(result.tests.front().passed);
}

TEST(Deterministic, MoreParametersThanOutputsNeedRegularisation) {
  const ThreeMasses structure;
  const Eigen::MatrixXd tests = frequencies_of(structure, oracle_parameters());
  const StructureModel one_output(
      separate(test::three_mass_system(), {{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}, {"k5", {"spring:k5"}}}),
      {.frequencies = {1}}, Eigen::VectorXd::Constant(3, 2.0));
  const UpdatingProblem problem{.model = one_output,
                                .derivatives = &one_output,
                                .space = *structure.space,
                                .tests = {tests.leftCols(1), Eigen::VectorXd::Zero(1)}};
  EXPECT_THROW(update(problem, {.regularisation = Regularisation::none}), InvalidInput);
  EXPECT_EQ(update(problem, {.regularisation = Regularisation::tikhonov}).status, UpdatingStatus::converged);
}

}  // namespace
}  // namespace mottle::updating
