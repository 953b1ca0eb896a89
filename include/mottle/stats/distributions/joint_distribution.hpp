// Several random variables together: marginal distributions tied by a normal copula, or a multivariate normal.
// Transforms uniforms into samples; the uniforms are made in sampling.hpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/distribution.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"

namespace mottle::stats {

/// Joint distribution of a model's parameters. Value type; const members may be called from many threads.
class JointDistribution {
 public:
  /// Independent variables.
  explicit JointDistribution(std::vector<Distribution> marginals);

  /// Variables tied by a normal copula: X_j = F_j^-1(Phi(w_j)), w ~ N(0, copula_correlation).
  ///
  /// @param copula_correlation  [variable x variable], correlation of w, which is that of X only between normals
  /// @throws InvalidInput  wrong size, not finite, not symmetric, diagonal not 1, not positive definite (says the
  ///                       smallest eigenvalue)
  /// Source: [Liu1986].
  JointDistribution(std::vector<Distribution> marginals, const Eigen::MatrixXd& copula_correlation);

  /// Multivariate normal; directions of zero variance are allowed.
  ///
  /// @param covariance  [variable x variable], symmetric, positive semi-definite to 1e-10 of the largest eigenvalue
  /// @throws InvalidInput  wrong size, not finite, not symmetric, or a negative eigenvalue (says it)
  static JointDistribution multivariate_normal(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);

  /// Variables whose transforms are together multivariate normal; directions of zero variance are allowed.
  ///
  /// @param transforms  one a variable
  /// @param mean        of the transformed variables [variable]
  /// @param covariance  of the transformed variables [variable x variable], as of multivariate_normal
  /// @throws InvalidInput  as multivariate_normal
  static JointDistribution transformed_normal(const std::vector<ParameterTransform>& transforms,
                                              const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);

  Eigen::Index dimension() const { return mean_.size(); }

  /// The marginals; empty for a multivariate normal, whose variables may have no variance.
  const std::vector<Distribution>& marginals() const { return marginals_; }

  Eigen::VectorXd mean() const { return mean_; }

  /// Covariance of the variables themselves, with what the copula does to marginals that are not normal:
  ///
  ///   cov(X_i, X_j) = sum_k a_ik a_jk rho_ij^k,   a_ik = E[X_i(w) h_k(w)],   h_k the orthonormal Hermite polynomials
  ///
  /// Accurate to 1e-10 relative to the standard deviations, U-shaped betas included; less for what is nearly a
  /// two-point distribution.
  /// Source: [Liu1986]; the series is Mehler's, [Kibble1945].
  Eigen::MatrixXd covariance() const { return covariance_; }

  /// Samples from uniforms: the inverse iso-probabilistic transform. Row i of the result depends on row i alone, bit
  /// for bit. Variable j is monotone in its own uniform; independent variables depend on no other.
  ///
  /// @param uniforms  [sample x variable], in the open interval (0, 1)
  /// @return          [sample x variable]
  /// @throws InvalidInput  wrong number of columns, or a value outside (0, 1)
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const;

  /// The same from independent standard normals w, as from_uniform(Phi(w)) but accurate in both tails.
  ///
  /// @param normals  [sample x variable], finite
  /// @throws InvalidInput  wrong number of columns
  Eigen::MatrixXd from_standard_normal(const Eigen::Ref<const Eigen::MatrixXd>& normals) const;

  /// The derivatives dx/dw of from_standard_normal() at one point: of a marginal phi(v) / f(x), v its own score; 0
  /// where the density f or phi has run out of numbers.
  ///
  /// @param normals  [variable]
  /// @return         [variable x normal]
  /// @throws InvalidInput  wrong number of entries
  Eigen::MatrixXd standard_normal_derivatives(const Eigen::Ref<const Eigen::VectorXd>& normals) const;

 private:
  JointDistribution() = default;

  std::vector<Distribution> marginals_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  std::vector<ParameterTransform> transforms_;  ///< of a transformed normal; empty for others
  Eigen::VectorXd transformed_mean_;            ///< and the mean of the transformed variables
  Eigen::MatrixXd factor_;  ///< of the copula's correlation, or of the covariance; empty for independent variables
};

}  // namespace mottle::stats
