// Principal axes of a covariance, taken in units of the variables so that none of them counts more for its unit.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {

/// C = D V diag(lambda) V' D, with D the diagonal of the units.
class CovarianceAxes {
 public:
  /// In units of the variables' own standard deviations: V and lambda are those of the correlation matrix.
  explicit CovarianceAxes(const Eigen::MatrixXd& covariance);
  /// @param unit  of each variable, > 0
  CovarianceAxes(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& unit);

  const Eigen::VectorXd& unit() const { return unit_; }
  const Eigen::VectorXd& variances() const { return axes_.eigenvalues(); }    ///< lambda, ascending
  const Eigen::MatrixXd& directions() const { return axes_.eigenvectors(); }  ///< V

  /// D V lambda^1/2 V', symmetric in the units: it changes smoothly with the covariance. Negative lambda count as zero.
  Eigen::MatrixXd symmetric_root() const;
  /// lambda^-1/2 V' D^-1: what has this covariance becomes independent of variance 1.
  /// @param min_variance  lambda below it counts as this
  Eigen::MatrixXd whitening(double min_variance) const;
  /// The same of one vector.
  Eigen::VectorXd whitened(const Eigen::VectorXd& vector, double min_variance) const;

 private:
  Eigen::VectorXd inverse_roots(double min_variance) const;

  Eigen::VectorXd unit_;
  SymmetricEigen axes_;
};

}  // namespace mottle::stats
