#include "updating/methods/covariance_adjustment.hpp"

#include <gtest/gtest.h>

#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

using CloudKind = CovarianceAdjustmentOptions::CloudKind;
using test::frequencies_of;
using test::oracle_parameters;
using test::standard_deviations;
using test::ThreeMasses;

UpdatingResult update(const UpdatingProblem& problem, const CovarianceAdjustmentOptions& options = {},
                      std::uint64_t seed = 1) {
  return CovarianceAdjustmentUpdater(options).update(problem, {.seed = seed});
}

TEST(CovarianceAdjustment, ReachesTheFirstOrderFixedPointOfTheThreeMasses) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-9;
  const UpdatingResult result = update(problem, {.cloud = CloudKind::first_order});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // validation/reference-rows: first order.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.09877159, 1.05074330, 0.96464297)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.29255890, 0.11781059, 0.23789794)).cwiseAbs().maxCoeff(),
            1e-8);
}

TEST(CovarianceAdjustment, TheCloudOfItsLastStateHasMeanAndCovarianceOfTheTests) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.tolerance = 1e-8;
  problem.iterations = 100;
  const UpdatingResult result = update(problem);
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // The state before the last is the method's own cloud at the same parameters to 1e-8.
  const TestMoments tests = test_moments(problem.tests);
  const Eigen::VectorXd scale = tests.covariance.diagonal().cwiseSqrt();
  // The last entry of the history is a cloud of its own (1000 independent samples): three standard errors.
  const IterationRecord& last = result.history.back();
  EXPECT_LT(((last.output_mean - tests.mean).array() / scale.array()).abs().maxCoeff(), 3.0 / std::sqrt(1000.0));
}

TEST(CovarianceAdjustment, WithAWideCloudItApproachesMomentMatching) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.cloud = {.samples = 16384, .design = SamplingDesign::sobol};
  problem.iterations = 100;
  problem.tolerance = 1e-6;
  const UpdatingResult result = update(problem);
  // validation/reference-rows: Gaussian moment matching, and its limit.
  EXPECT_LT((result.mean - Eigen::Vector3d(1.07780753, 1.09323337, 0.96010173)).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT((standard_deviations(result) - Eigen::Vector3d(0.28967961, 0.11086464, 0.23698861)).cwiseAbs().maxCoeff(),
            2e-3);
}

TEST(CovarianceAdjustment, StandardisedSamplesLeaveLittleMonteCarloError) {
  const ThreeMasses structure;
  UpdatingProblem problem = structure.problem(frequencies_of(structure, oracle_parameters()));
  problem.iterations = 100;
  const Eigen::VectorXd first = standard_deviations(update(problem, {}, 1));
  const Eigen::VectorXd second = standard_deviations(update(problem, {}, 2));
  // 1000 plain samples would leave 2.2 % on each deviation; of linear outputs nothing is left, of these half a per
  // cent.
  EXPECT_LT((first - second).cwiseAbs().cwiseQuotient(first).maxCoeff(), 0.02);
}

}  // namespace
}  // namespace mottle::updating
