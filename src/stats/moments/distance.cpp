#include "mottle/stats/moments/distance.hpp"

#include <Eigen/Core>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {

double euclidean_distance(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  require(a.size() == b.size(), "distance: vectors of {} and {} entries", a.size(), b.size());
  return (a - b).norm();
}

double mahalanobis_distance(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b,
                            const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  constexpr double k_rank_tolerance = 1e-12;
  require(a.size() == b.size(), "distance: vectors of {} and {} entries", a.size(), b.size());
  require(covariance.rows() == a.size() && covariance.cols() == a.size(), "covariance: {} x {} for {} variables",
          covariance.rows(), covariance.cols(), a.size());
  require(a.allFinite() && b.allFinite() && covariance.allFinite(), "distance: an entry is not finite");
  require((covariance.diagonal().array() >= 0.0).all(), "covariance: a variance is negative");
  if (a.size() == 0) return 0.0;

  const Eigen::VectorXd scale =
      covariance.diagonal().unaryExpr([](double variance) { return variance > 0.0 ? 1.0 / std::sqrt(variance) : 0.0; });
  // The eigenvalues serve the regular and the singular case alike; p is small and this is no hot path.
  const SymmetricEigen eigen(scale.asDiagonal() * covariance * scale.asDiagonal());
  const Eigen::VectorXd components = eigen.eigenvectors().transpose() * scale.cwiseProduct(a - b);
  const double threshold = k_rank_tolerance * eigen.eigenvalues().tail(1)[0];
  double squared = 0.0;
  for (Eigen::Index i = 0; i < components.size(); ++i) {
    if (eigen.eigenvalues()[i] > threshold) squared += components[i] * components[i] / eigen.eigenvalues()[i];
  }
  return std::sqrt(squared);
}

}  // namespace mottle::stats
