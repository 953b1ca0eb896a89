#include "updating/methods/deterministic_tests.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/matched_moments.hpp"

namespace mottle::updating {
namespace {

void plan_residual_test(const UpdatingProblem& problem, const StructureEstimate& estimate,
                        const Eigen::MatrixXd& sensitivity, TestPlan& plan) {
  const Eigen::MatrixXd b = unmoved_directions(sensitivity, estimate.measurement_std,
                                               problem.space.prior().covariance().diagonal().cwiseSqrt());
  const auto d = static_cast<double>(b.cols());
  if (d == 0.0) {
    plan.leave_untested_for_lack_of_outputs(
        Aspect::means,
        fmt::format("The outputs were not tested: {} of them are no more than the identifiable combinations of "
                    "parameters, so the residuals cannot tell whether the model is right. {}",
                    estimate.residual.size(), k_more_outputs));
    return;
  }
  const Eigen::VectorXd residual = b.transpose() * estimate.residual;
  const Eigen::MatrixXd covariance = b.transpose() * estimate.measurement_std.cwiseAbs2().asDiagonal() * b;
  PlannedTest test = chi_squared_test("residuals", residual.dot(solve_semidefinite(covariance, residual)), d);
  test.aspect = Aspect::means;
  test.meaning = fmt::format(
      "Chi-squared with {:.0f} degrees of freedom: are the residuals of the outputs, in the directions that no "
      "parameter "
      "moves, no larger than the measurement error?",
      d);
  test.power = [=](double level) {
    return Power{fmt::format("outputs that are off by {:.2g} standard deviations of the target in one of them",
                             std::sqrt(chi_squared_detectable(d, level)))};
  };
  plan.add(std::move(test));
}

}  // namespace

void test_structure(const UpdatingProblem& problem, const StructureEstimate& estimate, UpdatingResult& result) {
  TestPlan plan;
  plan_residual_test(problem, estimate, result.sensitivity, plan);
  const ScaledParameters parameters(problem.space);
  const Eigen::VectorXd point = from_variables(parameters.scales(), result.mean.transpose()).row(0);
  const Eigen::VectorXd slope = parameters.slopes(point).cwiseInverse();
  const FreeMean free{point + slope.cwiseProduct(estimate.free_step),
                      slope.asDiagonal() * result.covariance * slope.asDiagonal(),
                      std::numeric_limits<double>::infinity()};
  plan_bound_test(problem, free, plan);
  plan_prior_shift(problem, point, free.covariance, plan);
  plan.make(problem.level, result);
}

}  // namespace mottle::updating
