#include "updating/methods/mares.hpp"

#include <gtest/gtest.h>

#include "mottle/core/error.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using test::frequencies_of;
using test::oracle_parameters;
using test::standard_deviations;
using test::ThreeMasses;

UpdatingResult update(const UpdatingProblem& problem, const MaresOptions& options = {}, std::uint64_t seed = 1) {
  return MaresUpdater(options).update(problem, {.seed = seed});
}

TEST(Mares, TheDecodedReadingReproducesThePublishedMeansAndDeviations) {
  const ThreeMasses structure;
  const UpdatingResult result = update(structure.problem(frequencies_of(structure, oracle_parameters())));
  EXPECT_EQ(result.status, UpdatingStatus::converged);
  // docs/theory/mares.md, the defaults, which the published tables follow from; tolerances: Monte-Carlo error of 1000
  // samples.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.086, 1.076, 0.961)).cwiseAbs().maxCoeff(), 0.015);
  EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.2095, 0.110, 0.186)).cwiseAbs().maxCoeff(), 0.01);
}

TEST(Mares, TheDistanceOfTheMeansStartsAtThePublishedValueAndFallsByThreeOrders) {
  const ThreeMasses structure;
  const UpdatingResult result = update(structure.problem(frequencies_of(structure, oracle_parameters())));
  // Fig. 4 starts at 0.092 Hz; 0.002 is twice the Monte-Carlo error of the cloud's mean frequencies.
  EXPECT_NEAR(result.history.front().distance_euclidean, 0.092, 0.002);
  EXPECT_LT(result.history.back().distance_euclidean, 1e-4);
}

TEST(Mares, TheLiteralReadingFallsBackToTheStart) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.iterations = 12;
  const UpdatingResult result =
      update(problem, {.prior = MaresOptions::Prior::fixed, .covariance = MaresOptions::Covariance::recursive});
  EXPECT_EQ(result.status, UpdatingStatus::max_iterations);
  // docs/theory/mares.md, the equations as printed; 0.01 covers the Monte-Carlo error of the sensitivities.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.93, 1.91, 1.94)).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.119, 0.075, 0.067)).cwiseAbs().maxCoeff(), 0.005);
}

TEST(Mares, TheCovarianceIsEquation12AppliedToTheFirstPrior) {
  // Case of one mass and one spring has the closed form S = S0 V / (V + g^2 S0) with g = df/dk at the mean.
  const std::vector<ParameterTargets> targets{{"k", {"spring:k"}}};
  const Distribution prior({.kind = DistributionKind::normal, .mean = 100.0, .std = 1.0});
  const ParameterSpace space({{"k", "N/m", 50.0, 150.0, {}}}, JointDistribution({prior}));
  const MassSpringSystem system{.masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {}};
  const StructureModel model(separate(system, targets), {.frequencies = {1}}, Eigen::VectorXd::Constant(1, 100.0));
  Eigen::MatrixXd tests(3, 1);
  tests << 1.58, 1.60, 1.62;
  const UpdatingResult result = update({.model = model,
                                        .derivatives = &model,
                                        .space = space,
                                        .tests = {tests, Eigen::VectorXd::Zero(1)},
                                        .cloud = {.samples = 4000}});
  const double k = std::pow(2.0 * M_PI * 1.60, 2);
  const double g = 1.60 / (2.0 * k);
  const double variance = 0.02 * 0.02;
  // The slope of a regression over a cloud of 1 % width differs from the tangent by less than 1e-4.
  EXPECT_NEAR(result.mean(0), k, 1e-3 * k);
  EXPECT_NEAR(result.covariance(0, 0), variance / (variance + g * g), 1e-3);
}

TEST(Mares, WithAnOmittedSpringTheParametersEndOnThePublishedBounds) {
  const ThreeMasses truth(3.0);
  const ThreeMasses without_k6(0.0);
  const UpdatingResult result = update(without_k6.problem(frequencies_of(truth, oracle_parameters())));
  // Case 3 of the paper: k2 at its lower bound 0.5, k5 at its upper bound 3.
  EXPECT_EQ(without_k6.space->active_bounds(result.mean), Eigen::Vector3i(0, -1, 1));
}

TEST(Mares, EveryWeightingAndRegressionReachesTheTestedMeans) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.iterations = 500;
  for (const auto weighting : {MaresOptions::Weighting::mahalanobis, MaresOptions::Weighting::euclidean}) {
    for (const auto regression : {MaresOptions::Regression::linear, MaresOptions::Regression::quadratic}) {
      const UpdatingResult result = update(problem, {.weighting = weighting, .regression = regression});
      EXPECT_EQ(result.status, UpdatingStatus::converged);
      // Three parameters can match three means: what is left is what the stop rule leaves.
      EXPECT_LT(result.history.back().distance_euclidean, 1e-3);
    }
  }
}

TEST(Mares, ModelErrorWidensTheUpdatedCovariance) {
  const ThreeMasses structure;
  const UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  const Eigen::VectorXd without = standard_deviations(update(problem));
  const Eigen::VectorXd with = standard_deviations(update(problem, {.model_error = 0.05}));
  EXPECT_TRUE((with.array() > without.array()).all());
}

TEST(Mares, OneSpecimenIsRefusedWithTheMethodThatCanUseIt) {
  const ThreeMasses structure;
  const Eigen::MatrixXd tests = frequencies_of(structure, oracle_parameters()).topRows(1);
  try {
    update(structure.problem(tests));
    FAIL() << "one specimen was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("deterministic"), std::string::npos);
  }
}

TEST(Mares, SpecimensTooFewForTheirCovarianceAreRefusedUnlessTheModelErrorFillsIt) {
  const ThreeMasses structure;
  const Eigen::MatrixXd tests = frequencies_of(structure, oracle_parameters()).topRows(3);
  EXPECT_THROW(update(structure.problem(tests)), InvalidInput);
  EXPECT_NO_THROW(update(structure.problem(tests), {.model_error = 0.01}));
}

TEST(Mares, HistoryHoldsThePriorFirstAndTheEstimateLast) {
  const ThreeMasses structure;
  const UpdatingResult result = update(structure.problem(frequencies_of(structure, oracle_parameters())));
  EXPECT_EQ(result.history.front().parameter_mean, structure.space->prior().mean());
  EXPECT_EQ(result.history.back().parameter_mean, result.mean);
  EXPECT_EQ(result.history.back().cloud.samples.rows(), 1000);
}

}  // namespace
}  // namespace mottle::updating
