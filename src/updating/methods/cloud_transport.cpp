#include "updating/methods/cloud_transport.hpp"

#include <cmath>

#include "mottle/core/subject.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {
namespace {

/// Lower triangular factor of a covariance that may be singular to rounding.
Eigen::MatrixXd lower_factor(const Eigen::MatrixXd& covariance) {
  constexpr double k_rounding = 1e-10;
  const Eigen::VectorXd standard_deviation = covariance.diagonal().cwiseSqrt().cwiseMax(1e-300);
  Eigen::MatrixXd correlation = correlation_from_covariance(covariance);
  correlation.diagonal().array() += k_rounding;
  return standard_deviation.asDiagonal() * CholeskyFactor(correlation).lower();
}

/// factor^-1 (points - mean), row by row.
Eigen::MatrixXd standardised(const Eigen::MatrixXd& points, const Eigen::VectorXd& mean,
                             const Eigen::MatrixXd& factor) {
  return factor.triangularView<Eigen::Lower>().solve((points.rowwise() - mean.transpose()).transpose()).transpose();
}

}  // namespace

CloudTransport::CloudTransport(const Cloud& cloud, const ScaledParameters& parameters) {
  constexpr Eigen::Index k_samples_a_term = 3;
  const Cloud::Valid valid = cloud.valid();
  const Eigen::Index q = parameters.count();
  require_of(valid.samples.rows() >= k_samples_a_term * (q + 1), {Subject::Kind::option, "samples"},
             "{} samples of a cloud, without those that failed, are too few for {} parameters; method \"abc\" needs {}",
             valid.samples.rows(), q, k_samples_a_term * (q + 1));
  const Eigen::MatrixXd scaled = from_variables(parameters.scales(), valid.samples);
  mean_ = scaled.colwise().mean();
  factor_ = lower_factor(sample_covariance(scaled));
  base_.points = standardised(scaled, mean_, factor_);
  const LinearRegression line = linear_regression(base_.points, valid.outputs);
  curvature_ = (1.0 - line.r_squared.array()).max(0.0);
  is_quadratic_ = base_.points.rows() >= k_samples_a_term * (q * (q + 3) / 2 + 1);
  if (is_quadratic_) {
    surface_ = quadratic_regression(base_.points, valid.outputs);
  } else {
    surface_.centre = line.centre;
    surface_.constant = line.intercept;
    surface_.sensitivity = line.sensitivity;
  }
  reach_ = 3.0 + std::sqrt(static_cast<double>(q));
  base_.residual = valid.outputs - surface(base_.points);
}

TransportBase CloudTransport::thinned(Eigen::Index count) const {
  const Eigen::Index kept = std::min(std::max(count, 3 * (base_.points.cols() + 1)), base_.points.rows());
  TransportBase thin{base_.points.topRows(kept), base_.residual.topRows(kept)};
  const Eigen::VectorXd mean = thin.points.colwise().mean();
  const auto degrees = static_cast<double>(kept - 1) / static_cast<double>(kept);
  thin.points = standardised(thin.points, mean, lower_factor(degrees * sample_covariance(thin.points)));
  return thin;
}

Eigen::MatrixXd CloudTransport::surface(const Eigen::Ref<const Eigen::MatrixXd>& points) const {
  const Eigen::MatrixXd step = points.rowwise() - surface_.centre.transpose();
  Eigen::MatrixXd outputs = (step * surface_.sensitivity.transpose()).rowwise() + surface_.constant.transpose();
  if (!is_quadratic_) return outputs;
  const Eigen::ArrayXd length = step.rowwise().norm();
  const Eigen::ArrayXd weight =
      (length <= reach_).select(0.5, (reach_ * length - 0.5 * reach_ * reach_) / length.square().max(1e-300));
  for (Eigen::Index o = 0; o < outputs.cols(); ++o) {
    const Eigen::MatrixXd bent = step * surface_.hessian[static_cast<std::size_t>(o)];
    outputs.col(o).array() += weight * bent.cwiseProduct(step).rowwise().sum().array();
  }
  return outputs;
}

Eigen::MatrixXd CloudTransport::outputs(const SampledPopulation& population, const TransportBase& base) const {
  const auto lower = factor_.triangularView<Eigen::Lower>();
  const Eigen::MatrixXd map = lower.solve(population.factor);
  const Eigen::VectorXd shift = lower.solve(population.mean - mean_);
  return surface((base.points * map.transpose()).rowwise() + shift.transpose()) + base.residual;
}

Eigen::MatrixXd CloudTransport::sensitivity(const Eigen::Ref<const Eigen::VectorXd>& mean) const {
  const auto lower = factor_.triangularView<Eigen::Lower>();
  const Eigen::VectorXd step = lower.solve(mean - mean_) - surface_.centre;
  Eigen::MatrixXd slope = surface_.sensitivity;
  for (Eigen::Index o = 0; is_quadratic_ && o < slope.rows(); ++o) {
    slope.row(o) += (surface_.hessian[static_cast<std::size_t>(o)] * step).transpose();
  }
  return lower.transpose().solve(slope.transpose()).transpose();
}

}  // namespace mottle::updating
