#include "mottle/stats/distributions/joint_distribution.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "stats/distributions/copula_covariance.hpp"

namespace mottle::stats {

namespace {

void require_symmetric(const Eigen::MatrixXd& matrix, Eigen::Index dimension, const char* name) {
  require(matrix.rows() == dimension && matrix.cols() == dimension, "{}: {} x {} for {} variables", name, matrix.rows(),
          matrix.cols(), dimension);
  require(matrix.allFinite(), "{}: holds an entry that is not finite", name);
  for (Eigen::Index i = 0; i < dimension; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double scale = std::sqrt(std::abs(matrix(i, i))) * std::sqrt(std::abs(matrix(j, j)));
      require(std::abs(matrix(i, j) - matrix(j, i)) <= 1e-10 * scale,
              "{}: not symmetric, entry ({}, {}) is {} but ({}, {}) is {}", name, i, j, matrix(i, j), j, i,
              matrix(j, i));
    }
  }
}

void require_correlation(const Eigen::MatrixXd& correlation, Eigen::Index dimension) {
  require_symmetric(correlation, dimension, "correlation");
  for (Eigen::Index i = 0; i < dimension; ++i) {
    require(std::abs(correlation(i, i) - 1.0) <= 1e-10, "correlation: diagonal entry {} is {}, must be 1", i,
            correlation(i, i));
  }
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(correlation);
  require(eigenvalues[0] > 1e-12, "correlation: not positive definite, its smallest eigenvalue is {:.6g}",
          eigenvalues[0]);
}

/// Rows of `scores` times the transposed factor. Plain loops: a blocked product would round a row differently
/// depending on how many rows stand beside it.
Eigen::MatrixXd correlate(const Eigen::MatrixXd& scores, const Eigen::MatrixXd& factor) {
  Eigen::MatrixXd correlated = Eigen::MatrixXd::Zero(scores.rows(), scores.cols());
  for (Eigen::Index to = 0; to < scores.cols(); ++to) {
    double* target = correlated.col(to).data();
    for (Eigen::Index from = 0; from < scores.cols(); ++from) {
      const double weight = factor(to, from);
      if (weight == 0.0) continue;
      const double* source = scores.col(from).data();
      for (Eigen::Index row = 0; row < scores.rows(); ++row) target[row] += weight * source[row];
    }
  }
  return correlated;
}

}  // namespace

JointDistribution::JointDistribution(std::vector<Distribution> marginals) : marginals_(std::move(marginals)) {
  const auto dimension = static_cast<Eigen::Index>(marginals_.size());
  mean_.resize(dimension);
  covariance_ = Eigen::MatrixXd::Zero(dimension, dimension);
  for (Eigen::Index i = 0; i < dimension; ++i) {
    const Distribution& marginal = marginals_[static_cast<std::size_t>(i)];
    mean_[i] = marginal.mean();
    covariance_(i, i) = marginal.standard_deviation() * marginal.standard_deviation();
  }
}

JointDistribution::JointDistribution(std::vector<Distribution> marginals, const Eigen::MatrixXd& copula_correlation)
    : JointDistribution(std::move(marginals)) {
  require_correlation(copula_correlation, dimension());
  if (copula_correlation.isIdentity(0.0)) return;
  covariance_ = copula_covariance(marginals_, copula_correlation);
  factor_ = CholeskyFactor(copula_correlation).lower();
}

JointDistribution JointDistribution::multivariate_normal(const Eigen::VectorXd& mean,
                                                         const Eigen::MatrixXd& covariance) {
  require(mean.allFinite(), "mean: holds an entry that is not finite");
  require_symmetric(covariance, mean.size(), "covariance");
  JointDistribution normal;
  normal.mean_ = mean;
  normal.covariance_ = 0.5 * (covariance + covariance.transpose());
  if (mean.size() == 0) return normal;
  // The root is taken of the correlation, so that the same uniforms give the same samples in any units.
  const Eigen::VectorXd standard_deviation = normal.covariance_.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd scale = (standard_deviation.array() > 0.0).select(standard_deviation, 1.0);
  const SymmetricEigen eigen(scale.cwiseInverse().asDiagonal() * normal.covariance_ *
                             scale.cwiseInverse().asDiagonal());
  const double smallest = eigen.eigenvalues()[0];
  require(smallest >= -1e-10 * eigen.eigenvalues().cwiseAbs().maxCoeff(),
          "covariance: not positive semi-definite, as a correlation its smallest eigenvalue is {:.6g}", smallest);
  normal.factor_ = scale.asDiagonal() * eigen.eigenvectors() *
                   eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  return normal;
}

JointDistribution JointDistribution::transformed_normal(const std::vector<ParameterTransform>& transforms,
                                                        const Eigen::VectorXd& mean,
                                                        const Eigen::MatrixXd& covariance) {
  require(static_cast<Eigen::Index>(transforms.size()) == mean.size(), "{} scales for {} variables", transforms.size(),
          mean.size());
  JointDistribution result = multivariate_normal(mean, covariance);
  if (std::all_of(transforms.begin(), transforms.end(),
                  [](const ParameterTransform& s) { return s.kind == ParameterTransform::Kind::identity; })) {
    return result;
  }
  result.transforms_ = transforms;
  result.transformed_mean_ = mean;
  VariableMoments moments = moments_of_variables(transforms, mean, result.covariance_);
  result.mean_ = std::move(moments.mean);
  result.covariance_ = std::move(moments.covariance);
  repair_covariance(result.covariance_);  // its entries are integrals, each with an error of its own
  return result;
}

Eigen::MatrixXd JointDistribution::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  require(uniforms.cols() == dimension(), "uniforms: {} columns for {} variables", uniforms.cols(), dimension());
  require((uniforms.array() > 0.0 && uniforms.array() < 1.0).all(), "uniforms: a value is outside (0, 1)");
  Eigen::MatrixXd samples(uniforms.rows(), uniforms.cols());
  if (factor_.size() == 0) {
    for (Eigen::Index j = 0; j < dimension(); ++j) {
      const Distribution& marginal = marginals_[static_cast<std::size_t>(j)];
      samples.col(j) = uniforms.col(j).unaryExpr([&](double uniform) { return marginal.quantile(uniform); });
    }
    return samples;
  }
  return from_standard_normal(uniforms.unaryExpr([](double uniform) { return standard_normal_quantile(uniform); }));
}

Eigen::MatrixXd JointDistribution::from_standard_normal(const Eigen::Ref<const Eigen::MatrixXd>& normals) const {
  require(normals.cols() == dimension(), "normals: {} columns for {} variables", normals.cols(), dimension());
  Eigen::MatrixXd samples = factor_.size() == 0 ? Eigen::MatrixXd(normals) : correlate(normals, factor_);
  if (!transforms_.empty()) {
    samples.rowwise() += transformed_mean_.transpose();
    return to_variables(transforms_, samples);
  }
  if (marginals_.empty()) return samples.rowwise() + mean_.transpose();
  for (Eigen::Index j = 0; j < dimension(); ++j) {
    const Distribution& marginal = marginals_[static_cast<std::size_t>(j)];
    samples.col(j) = samples.col(j).unaryExpr([&](double score) { return marginal.from_standard_normal(score); });
  }
  return samples;
}

Eigen::MatrixXd JointDistribution::standard_normal_derivatives(const Eigen::Ref<const Eigen::VectorXd>& normals) const {
  require(normals.size() == dimension(), "normals: {} entries for {} variables", normals.size(), dimension());
  const Eigen::VectorXd scores = factor_.size() == 0 ? Eigen::VectorXd(normals) : Eigen::VectorXd(factor_ * normals);
  Eigen::VectorXd slopes = Eigen::VectorXd::Ones(dimension());
  for (Eigen::Index j = 0; j < dimension(); ++j) {
    const auto k = static_cast<std::size_t>(j);
    if (!transforms_.empty()) {
      slopes(j) = transforms_[k].slope(scores(j) + transformed_mean_(j));
    } else if (!marginals_.empty()) {
      const double slope =
          standard_normal_pdf(scores(j)) / marginals_[k].pdf(marginals_[k].from_standard_normal(scores(j)));
      slopes(j) = std::isfinite(slope) ? slope : 0.0;
    }
  }
  if (factor_.size() == 0) return slopes.asDiagonal();
  return slopes.asDiagonal() * factor_;
}

}  // namespace mottle::stats
