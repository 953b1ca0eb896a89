#include "mottle/stats/moments/descriptive.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {

Eigen::VectorXd sample_mean(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  require(samples.rows() >= 1, "samples: no rows, need at least 1");
  return samples.colwise().mean();
}

Eigen::MatrixXd sample_covariance(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  require(samples.rows() >= 2, "samples: {} rows, a covariance needs at least 2", samples.rows());
  require(samples.allFinite(), "samples: an entry is not finite");
  const Eigen::MatrixXd centred = samples.rowwise() - samples.colwise().mean();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(samples.cols(), samples.cols());
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(centred.transpose(),
                                                        1.0 / static_cast<double>(samples.rows() - 1));
  covariance.triangularView<Eigen::StrictlyUpper>() = covariance.transpose();
  return covariance;
}

Eigen::VectorXd sample_standard_deviation(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  require(samples.rows() >= 2, "samples: {} rows, a standard deviation needs at least 2", samples.rows());
  require(samples.allFinite(), "samples: an entry is not finite");
  const Eigen::MatrixXd centred = samples.rowwise() - samples.colwise().mean();
  return centred.colwise().norm().transpose() / std::sqrt(static_cast<double>(samples.rows() - 1));
}

Eigen::MatrixXd correlation_from_covariance(const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  require(covariance.rows() == covariance.cols(), "covariance: {} x {} is not square", covariance.rows(),
          covariance.cols());
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    require(covariance(i, i) >= 0.0, "covariance: variance {} is {}, must not be negative", i, covariance(i, i));
  }
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols());
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      const double scale = std::sqrt(covariance(i, i)) * std::sqrt(covariance(j, j));
      if (i != j && scale > 0.0) correlation(i, j) = std::clamp(covariance(i, j) / scale, -1.0, 1.0);
    }
  }
  return correlation;
}

namespace {

/// Covariance of the rows that hold both columns; 0 where fewer than two do.
double pairwise_covariance(const Eigen::Ref<const Eigen::MatrixXd>& samples, Eigen::Index i, Eigen::Index j) {
  const auto both = !samples.col(i).array().isNaN() && !samples.col(j).array().isNaN();
  const auto count = static_cast<double>(both.count());
  if (count < 2.0) return 0.0;
  const double mean_i = both.select(samples.col(i).array(), 0.0).sum() / count;
  const double mean_j = both.select(samples.col(j).array(), 0.0).sum() / count;
  const auto products = (samples.col(i).array() - mean_i) * (samples.col(j).array() - mean_j);
  return both.select(products, 0.0).sum() / (count - 1.0);
}

}  // namespace

bool repair_covariance(Eigen::MatrixXd& covariance, double min_eigenvalue) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (covariance(i, i) > 0.0) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
  }
  const Eigen::VectorXd standard_deviation = covariance.diagonal().cwiseSqrt();
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols());
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      // Not clamped: a pair whose covariance exceeds what its variances allow is one of the faults to be mended.
      if (i != j && standard_deviation[i] > 0.0 && standard_deviation[j] > 0.0) {
        correlation(i, j) = covariance(i, j) / standard_deviation[i] / standard_deviation[j];
      }
    }
  }
  const SymmetricEigen eigen(correlation);
  const double largest = eigen.eigenvalues().tail(1)[0];
  const double rounding = 100.0 * static_cast<double>(covariance.rows()) * std::numeric_limits<double>::epsilon();
  if (eigen.eigenvalues()[0] >= (min_eigenvalue - rounding) * largest) return false;

  const Eigen::VectorXd kept = eigen.eigenvalues().cwiseMax(min_eigenvalue * largest).cwiseSqrt();
  const Eigen::MatrixXd root = eigen.eigenvectors() * kept.asDiagonal();
  const Eigen::MatrixXd scaled = standard_deviation.cwiseQuotient(root.rowwise().norm()).asDiagonal() * root;
  const Eigen::VectorXd variances = covariance.diagonal();
  covariance.noalias() = scaled * scaled.transpose();
  covariance.triangularView<Eigen::StrictlyUpper>() = covariance.transpose();
  covariance.diagonal() = variances;
  constexpr double k_beyond_rounding = 1e-8;
  return eigen.eigenvalues()[0] < -k_beyond_rounding * largest;
}

SampleMoments available_case_moments(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  require(!samples.array().isInf().any(), "samples: an entry is infinite");
  const Eigen::Index dimension = samples.cols();
  SampleMoments moments{Eigen::VectorXi(dimension), Eigen::VectorXd(dimension), Eigen::MatrixXd(dimension, dimension)};
  for (Eigen::Index i = 0; i < dimension; ++i) {
    const auto present = !samples.col(i).array().isNaN();
    moments.count[i] = static_cast<int>(present.count());
    require(moments.count[i] >= 2, "column {} (from 0): {} values present, need at least 2", i, moments.count[i]);
    moments.mean[i] = present.select(samples.col(i).array(), 0.0).sum() / moments.count[i];
    for (Eigen::Index j = 0; j <= i; ++j) {
      moments.covariance(i, j) = pairwise_covariance(samples, i, j);
      moments.covariance(j, i) = moments.covariance(i, j);
    }
  }
  // A complete sample's covariance is positive semi-definite by construction.
  if (dimension > 0 && samples.array().isNaN().any()) moments.was_repaired = repair_covariance(moments.covariance);
  return moments;
}

}  // namespace mottle::stats
