#include "updating/methods/inversion.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using test::frequencies_of;
using test::oracle_parameters;
using test::standard_deviations;
using test::ThreeMasses;

UpdatingResult update(const UpdatingProblem& problem, const InversionOptions& options = {}) {
  return InversionUpdater(options).update(problem, {.seed = 1});
}

TEST(Inversion, GivesTheSpecimensOfTheThreeMassesBack) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-8;
  const UpdatingResult result = update(problem);
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  ASSERT_TRUE(result.specimens.has_value());
  EXPECT_LT((result.specimens->parameters - oracle_parameters()).cwiseAbs().maxCoeff(), 1e-7);
  // The mean and deviation that the specimens were made to have: validation/reference-rows.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.08, 1.09, 0.96)).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.288, 0.130, 0.241)).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Inversion, NeedsNoDerivativesOfTheModel) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.derivatives = nullptr;
  problem.tolerance = 1e-8;
  EXPECT_LT((update(problem).mean - Eigen::Vector3d(1.08, 1.09, 0.96)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Inversion, StatesTheIntervalsOfANormalSample) {
  const ThreeMasses structure;
  const UpdatingResult result = update(structure.problem(frequencies_of(structure, oracle_parameters())));
  ASSERT_TRUE(result.intervals.has_value());
  EXPECT_EQ(result.intervals->made_by, "analytic");
  // Tables: t(0.975, 9) = 2.262157; chi-squared(9) at 0.975 and 0.025: 19.022768, 2.700389.
  const double half = 2.262157 * 0.288 / std::sqrt(10.0);
  EXPECT_NEAR(result.intervals->mean(0, 0), 1.08 - half, 1e-5);
  EXPECT_NEAR(result.intervals->mean(0, 1), 1.08 + half, 1e-5);
  EXPECT_NEAR(result.intervals->std(0, 0), 0.288 * std::sqrt(9.0 / 19.022768), 1e-5);
  EXPECT_NEAR(result.intervals->std(0, 1), 0.288 * std::sqrt(9.0 / 2.700389), 1e-5);
  // The specimens are uncorrelated: rho* = -Z / chi(9) is Student's t with 9 degrees of freedom over 3.
  const double tangent = 2.262157163 / 3.0;
  EXPECT_NEAR(result.intervals->correlation_upper(0, 1), tangent / std::sqrt(1.0 + tangent * tangent), 1e-5);
  EXPECT_NEAR(result.intervals->correlation_lower(0, 1), -result.intervals->correlation_upper(0, 1), 1e-5);
}

TEST(Inversion, WeightsTheOutputsByTheirRepeatability) {
  Eigen::MatrixXd slope(3, 2);
  slope << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7;
  const test::LinearModel model(Eigen::Vector3d(1.0, 0.0, 2.0), slope);
  const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.5});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({prior, prior}));
  Eigen::MatrixXd tests(3, 3);
  tests << 3.0, 2.5, 4.4, 2.8, 2.1, 4.2, 3.3, 2.0, 4.9;
  const Eigen::Vector3d sigma(0.1, 0.2, 0.05);
  const UpdatingResult result = update({.model = model, .space = space, .tests = {tests, sigma}, .tolerance = 1e-9});
  const Eigen::MatrixXd gw = slope.transpose() * sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  for (int s = 0; s < 3; ++s) {
    const Eigen::Vector3d right = tests.row(s).transpose() - Eigen::Vector3d(1.0, 0.0, 2.0);
    const Eigen::Vector2d solution = (gw * slope).inverse() * (gw * right);
    EXPECT_LT((result.specimens->parameters.row(s).transpose() - solution).cwiseAbs().maxCoeff(), 1e-8);
  }
  const double first = (tests(0, 0) - 1.0 - slope.row(0).dot(result.specimens->parameters.row(0))) / 0.1;
  EXPECT_NEAR(result.specimens->residuals(0, 0), first, 1e-9);
}

TEST(Inversion, ASpecimenThatDoesNotDetermineItsParametersStaysNearestToThePrior) {
  const test::LinearModel model(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity());
  const Distribution prior({.kind = DistributionKind::normal, .mean = 5.0, .std = 0.5});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({prior, prior}));
  Eigen::MatrixXd tests(3, 2);
  tests << 4.0, 6.0, 4.5, std::numeric_limits<double>::quiet_NaN(), 4.2, 6.2;
  const UpdatingResult result = update({.model = model, .space = space, .tests = {tests, Eigen::Vector2d::Zero()}});
  EXPECT_NEAR(result.specimens->parameters(1, 0), 4.5, 1e-9);
  EXPECT_NEAR(result.specimens->parameters(1, 1), 5.0, 1e-9);
  EXPECT_TRUE(std::isnan(result.specimens->residuals(1, 1)));
  bool is_said = false;
  for (const std::string& note : result.notes) is_said = is_said || note.find("1 of 3 specimens") != std::string::npos;
  EXPECT_TRUE(is_said);
}

TEST(Inversion, KeepsEverySpecimenWithinTheBounds) {
  const ThreeMasses truth(3.0);
  const ThreeMasses without_k6(0.0);
  const UpdatingResult result = update(without_k6.problem(frequencies_of(truth, oracle_parameters())));
  EXPECT_GE(result.specimens->parameters.minCoeff(), 0.5);
  EXPECT_LE(result.specimens->parameters.maxCoeff(), 3.0);
}

TEST(Inversion, SaysHowMuchOfTheScatterIsNoise) {
  // y = x with noise of half the scatter's variance: the share is R / V by definition.
  const test::LinearModel model(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Identity(1, 1));
  const Distribution prior({.kind = DistributionKind::normal, .mean = 5.0, .std = 0.5});
  const ParameterSpace space({{"a", "-"}}, JointDistribution({prior}));
  const Eigen::MatrixXd tests = Eigen::Vector3d(4.0, 5.0, 6.0);
  const UpdatingResult result =
      update({.model = model, .space = space, .tests = {tests, Eigen::VectorXd::Constant(1, std::sqrt(0.5))}});
  EXPECT_NE(result.notes.at(1).find("50 % of a"), std::string::npos) << result.notes.at(1);
}

TEST(Inversion, OneSpecimenIsRefused) {
  const ThreeMasses structure;
  EXPECT_THROW(update(structure.problem(frequencies_of(structure, oracle_parameters()).topRows(1))), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
