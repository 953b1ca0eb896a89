#include "updating/methods/shared_offset.hpp"

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "updating/methods/matched_residuals.hpp"
#include "updating/population/mean_intervals.hpp"

namespace mottle::updating {

SharedOffset::SharedOffset(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& slopes,
                           const Eigen::Ref<const Eigen::MatrixXd>& cloud) {
  constexpr double k_unseen = 1e-6;
  const Eigen::VectorXd variance = problem.tests.model_error_variance();
  if (variance.isZero(0.0)) return;
  std_ = variance.cwiseSqrt();
  reference_ = cloud.colwise().mean();
  const Eigen::MatrixXd of_mean = covariance_of_tests_mean(problem.tests, sample_covariance(cloud));
  const Eigen::VectorXd scale = of_mean.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd directions = unmoved_directions(slopes, scale, Eigen::VectorXd::Ones(slopes.cols()));
  const Eigen::Index p = variance.size();
  gain_ = Eigen::MatrixXd::Zero(p, p);
  if (directions.cols() > 0) {
    const Eigen::MatrixXd own = directions.transpose() * of_mean * directions;
    gain_ = variance.asDiagonal() * directions * solve_semidefinite(own, directions.transpose());
  }
  const CholeskyFactor factor(of_mean);
  const Eigen::MatrixXd whitening = factor.solve_lower(Eigen::MatrixXd::Identity(p, p));
  const Eigen::MatrixXd inverse = LeastNormSolver(whitening * slopes, k_unseen).pseudo_inverse() * whitening;  // L
  rest_ = Eigen::MatrixXd::Identity(p, p) - slopes * inverse;
  const Eigen::MatrixXd left = Eigen::MatrixXd(variance.asDiagonal()) - gain_ * variance.asDiagonal();
  const SymmetricEigen moved(inverse * left * inverse.transpose());
  mean_factor_ = moved.eigenvectors() * moved.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

Eigen::RowVectorXd SharedOffset::residual(const Eigen::MatrixXd& tests) const {
  const auto is_missing = tests.array().isNaN();
  const Eigen::ArrayXXd values = is_missing.select(0.0, tests.array());
  const Eigen::Array<double, 1, Eigen::Dynamic> count = (!is_missing).cast<double>().colwise().sum();
  return (count > 0.0).select(values.colwise().sum() / count.max(1.0) - reference_.array(), 0.0).matrix();
}

Eigen::MatrixXd SharedOffset::taken_off(const Eigen::MatrixXd& tests) const {
  if (is_none()) return tests;
  return tests.rowwise() - residual(tests) * gain_.transpose();
}

Eigen::MatrixXd SharedOffset::displaced(const Eigen::MatrixXd& tests,
                                        const Eigen::Ref<const Eigen::VectorXd>& normal) const {
  if (is_none()) return tests;
  const Eigen::RowVectorXd error = std_.cwiseProduct(normal).transpose();
  const Eigen::RowVectorXd known = (residual(tests) + error) * gain_.transpose();
  return tests.rowwise() + (error - known) * rest_.transpose();
}

}  // namespace mottle::updating
