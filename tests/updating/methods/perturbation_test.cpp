#include "updating/methods/perturbation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "mottle/core/error.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using test::frequencies_of;
using test::oracle_parameters;
using test::ThreeMasses;

UpdatingResult update(const UpdatingProblem& problem, const PerturbationOptions& options = {}) {
  return PerturbationUpdater(options).update(problem, {.seed = 1});
}

TEST(Perturbation, ReachesTheFirstOrderFixedPointOfTheThreeMasses) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-9;
  const UpdatingResult result = update(problem);
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // validation/reference-rows, first order, given to eight digits.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.09877159, 1.05074330, 0.96464297)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((result.covariance.diagonal().cwiseSqrt() - Eigen::Vector3d(0.29255890, 0.11781059, 0.23789794))
                .cwiseAbs()
                .maxCoeff(),
            1e-8);
}

/// y = G x, three outputs of two parameters, six specimens.
struct LinearCase {
  LinearCase() : model(Eigen::Vector3d::Zero(), slope()), tests(6, 3) {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.5});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{"a", "-"}, {"b", "-"}},
                                             JointDistribution({prior, prior}));
    tests << 3.0, 2.5, 2.4, 2.8, 2.1, 2.2, 3.3, 2.0, 2.9, 2.9, 2.2, 2.0, 3.1, 2.6, 2.5, 2.6, 2.4, 2.1;
    covariance = (tests.rowwise() - tests.colwise().mean()).transpose() *
                 (tests.rowwise() - tests.colwise().mean()).matrix() / 5.0;
  }
  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(3, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7;
    return g;
  }
  UpdatingProblem problem(double noise) const {
    return {.model = model, .space = *space, .tests = {tests, Eigen::Vector3d::Constant(noise)}, .tolerance = 1e-10};
  }
  test::LinearModel model;
  std::unique_ptr<ParameterSpace> space;
  Eigen::MatrixXd tests;
  Eigen::Matrix3d covariance;
};

TEST(Perturbation, IsWeightedLeastSquaresOfMeanAndCovarianceForALinearModel) {
  const LinearCase linear;
  const Eigen::MatrixXd g = LinearCase::slope();
  const Eigen::Matrix3d noise = 0.0025 * Eigen::Matrix3d::Identity();
  for (const MomentWeighting weighting : {MomentWeighting::variance, MomentWeighting::covariance}) {
    const Eigen::Matrix3d weight = weighting == MomentWeighting::covariance
                                       ? Eigen::Matrix3d(linear.covariance.inverse())
                                       : Eigen::Matrix3d(linear.covariance.diagonal().cwiseInverse().asDiagonal());
    const Eigen::MatrixXd t = (g.transpose() * weight * g).inverse() * g.transpose() * weight;
    const UpdatingResult result = update(linear.problem(0.05), {.weighting = weighting});
    EXPECT_LT((result.mean - t * linear.tests.colwise().mean().transpose()).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LT((result.covariance - t * (linear.covariance - noise) * t.transpose()).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(Perturbation, NoiseBeyondTheScatterLeavesACovarianceAndIsSaid) {
  const LinearCase linear;
  const UpdatingResult result = update(linear.problem(1.0));
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_LT(result.covariance.cwiseAbs().maxCoeff(), 1e-12);
  bool is_said = false;
  for (const std::string& note : result.notes) is_said = is_said || note.find("negative variance") != std::string::npos;
  EXPECT_TRUE(is_said);
}

TEST(Perturbation, TheDiagonalCovarianceIsTheBestFitOfThatPattern) {
  const LinearCase linear;
  UpdatingProblem problem = linear.problem(0.0);
  problem.covariance_groups = {0, 1};
  const Eigen::VectorXd variances = update(problem).covariance.diagonal();
  // min over s of |V - s1 g1 g1' - s2 g2 g2'| with entries over the deviations of both outputs: two normal equations.
  const Eigen::Vector3d scale = linear.covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd g = scale.asDiagonal() * LinearCase::slope();
  const Eigen::Matrix3d v = scale.asDiagonal() * linear.covariance * scale.asDiagonal();
  Eigen::Matrix2d normal;
  Eigen::Vector2d right;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) normal(i, j) = std::pow(g.col(i).dot(g.col(j)), 2);
    right(i) = g.col(i).dot(v * g.col(i));
  }
  EXPECT_LT((variances - normal.inverse() * right).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Perturbation, ChangesThePriorLeastWithFewerOutputsThanParameters) {
  const test::LinearModel narrow(Eigen::VectorXd::Constant(1, 1.0), Eigen::RowVector2d(1.0, 0.5));
  const Distribution first({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.5});
  const Distribution second({.kind = DistributionKind::normal, .mean = 3.0, .std = 1.0});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({first, second}));
  const Eigen::MatrixXd tests = Eigen::Vector3d(4.0, 5.0, 6.0);
  const UpdatingResult result = update({.model = narrow, .space = space, .tests = {tests, Eigen::VectorXd::Zero(1)}});
  // In prior deviations u = (x - x0) / (0.5, 1) the output is 4.5 + (u1 + u2) / 2: mean 5 at u = (0.5, 0.5).
  EXPECT_LT((result.mean - Eigen::Vector2d(2.25, 3.5)).cwiseAbs().maxCoeff(), 1e-9);
  Eigen::Matrix2d scaled;
  scaled << 1.5, 0.5, 0.5, 1.5;  // along (1, 1): (1, 1) S (1, 1)' / 4 = 1 is the tests' variance; across: the prior
  const Eigen::Matrix2d expected =
      Eigen::Vector2d(0.5, 1.0).asDiagonal() * scaled * Eigen::Vector2d(0.5, 1.0).asDiagonal();
  EXPECT_LT((result.covariance - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Perturbation, OneSpecimenIsRefused) {
  const ThreeMasses structure;
  EXPECT_THROW(update(structure.problem(frequencies_of(structure, oracle_parameters()).topRows(1))), InvalidInput);
}

TEST(Perturbation, ASingularCovarianceIsRefusedAsAWeight) {
  const ThreeMasses structure;
  EXPECT_THROW(update(structure.problem(frequencies_of(structure, oracle_parameters()).topRows(3)),
                      {.weighting = MomentWeighting::covariance}),
               InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
