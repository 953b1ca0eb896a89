#include "updating/methods/matched_residuals.hpp"

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {

Eigen::MatrixXd unmoved_directions(const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                                   const Eigen::Ref<const Eigen::VectorXd>& output_scale,
                                   const Eigen::Ref<const Eigen::VectorXd>& parameter_scale) {
  constexpr double k_unseen = 1e-6;
  const Eigen::VectorXd unit = output_scale.cwiseInverse();
  const SingularValues svd(unit.asDiagonal() * sensitivity * parameter_scale.asDiagonal(), Eigen::ComputeFullU);
  const Eigen::VectorXd& values = svd.values();
  const Eigen::Index rank = (values.array() > k_unseen * values(0)).count();
  return unit.asDiagonal() * svd.left().rightCols(sensitivity.rows() - rank);
}

MatchedResiduals MatchedResiduals::between(TestMoments tests, const Eigen::Ref<const Eigen::VectorXd>& cloud_mean,
                                           Eigen::MatrixXd of_test,
                                           const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                                           const Eigen::Ref<const Eigen::VectorXd>& parameter_scale) {
  MatchedResiduals r{std::move(tests), {}, std::move(of_test), {}};
  r.residual = r.tests.mean - cloud_mean;
  Eigen::VectorXd scale = r.of_test.diagonal().cwiseMax(r.tests.covariance.diagonal()).cwiseSqrt();
  scale = scale.cwiseMax(k_last_digits * r.tests.mean.cwiseAbs());
  scale = (scale.array() > 0.0).select(scale, r.tests.mean.cwiseAbs().cwiseMax(1e-300));
  r.directions = unmoved_directions(sensitivity, scale, parameter_scale);
  return r;
}

double MatchedResiduals::mean_squares(const Eigen::Ref<const Eigen::MatrixXd>& covariance) const {
  const Eigen::MatrixXd own = directions.transpose() * covariance * directions;
  const Eigen::VectorXd off = directions.transpose() * residual;
  constexpr double k_singular = 1e-12;
  const Eigen::VectorXd pivots = semidefinite_pivots(own);
  if (!(pivots.minCoeff() > k_singular * pivots.maxCoeff())) return -1.0;
  return off.dot(solve_semidefinite(own, off));
}

}  // namespace mottle::updating
