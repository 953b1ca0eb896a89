#include "mottle/stats/moments/covariance_axes.hpp"

namespace mottle::stats {
namespace {

Eigen::MatrixXd in_units(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& unit) {
  return unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal();
}

}  // namespace

CovarianceAxes::CovarianceAxes(const Eigen::MatrixXd& covariance)
    : CovarianceAxes(covariance, covariance.diagonal().cwiseMax(1e-300).cwiseSqrt()) {}

CovarianceAxes::CovarianceAxes(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& unit)
    : unit_(unit), axes_(in_units(covariance, unit)) {}

Eigen::MatrixXd CovarianceAxes::symmetric_root() const {
  return unit_.asDiagonal() * directions() * variances().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         directions().transpose();
}

Eigen::VectorXd CovarianceAxes::inverse_roots(double min_variance) const {
  return variances().cwiseMax(min_variance).cwiseSqrt().cwiseInverse();
}

Eigen::MatrixXd CovarianceAxes::whitening(double min_variance) const {
  return inverse_roots(min_variance).asDiagonal() * directions().transpose() * unit_.cwiseInverse().asDiagonal();
}

Eigen::VectorXd CovarianceAxes::whitened(const Eigen::VectorXd& vector, double min_variance) const {
  return inverse_roots(min_variance).asDiagonal() * (directions().transpose() * vector.cwiseQuotient(unit_));
}

}  // namespace mottle::stats
