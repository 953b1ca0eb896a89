#include "random_effects_step.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle {
namespace {

/// C^-1 and log det C of a covariance that may be singular to rounding: a part in 1e13 of its diagonal is added.
std::pair<Eigen::MatrixXd, double> invert(Eigen::MatrixXd covariance) {
  constexpr double k_floor = 1e-13;
  covariance.diagonal() *= 1.0 + k_floor;
  constexpr double k_no_variance = 1e-200;  // its inverse, and products of that, are still numbers
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(k_no_variance).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  if (!scaled.allFinite()) throw SystemFailure("random effects: the covariance of a unit is not finite");
  Eigen::LLT<Eigen::MatrixXd> factor(scaled);
  for (double lift = k_floor; factor.info() != Eigen::Success; lift *= 10.0) {
    factor.compute(scaled + lift * Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  }
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  const double log_det = 2.0 * factor.matrixLLT().diagonal().array().log().sum() - 2.0 * scale.array().log().sum();
  return {scale.asDiagonal() * inverse * scale.asDiagonal(), log_det};
}

}  // namespace

RandomEffectsPass::RandomEffectsPass(const std::vector<RandomEffectsUnit>& observed, const Eigen::MatrixXd& covariance,
                                     const Eigen::VectorXd& factors, const RandomEffectsSettings& settings) {
  const Eigen::Index q = covariance.rows();
  const bool has_origin = settings.mean_origin.size() == q;
  const Eigen::MatrixXd directions =
      has_origin ? settings.mean_directions : Eigen::MatrixXd(Eigen::MatrixXd::Identity(q, q));
  mean = has_origin ? settings.mean_origin : Eigen::VectorXd(Eigen::VectorXd::Zero(q));
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(q, q);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(q);
  units.resize(observed.size());
  for (std::size_t s = 0; s < observed.size(); ++s) {
    const RandomEffectsUnit& from = observed[s];
    Unit& unit = units[s];
    unit.noise = from.noise;
    for (std::size_t k = 0; k < from.factor.size(); ++k) {
      if (from.factor[k] >= 0) unit.noise(static_cast<Eigen::Index>(k)) *= factors(from.factor[k]);
    }
    Eigen::MatrixXd total = from.design * covariance * from.design.transpose();
    total.diagonal() += unit.noise;
    double log_det = 0.0;
    std::tie(unit.precision, log_det) = invert(std::move(total));
    unit.weighted = from.design.transpose() * unit.precision;
    unit.seen = unit.weighted * from.design;
    information += unit.seen;
    gradient += unit.weighted * (from.response - from.design * mean);
    log_likelihood -= 0.5 * log_det;
  }
  mean_variance = Eigen::MatrixXd::Zero(q, q);
  if (directions.cols() > 0) {
    const auto [inverse, log_det] = invert(directions.transpose() * information * directions);
    mean_variance = directions * inverse * directions.transpose();
    if (settings.is_restricted) log_likelihood -= 0.5 * log_det;
  }
  mean += mean_variance * gradient;
  for (std::size_t s = 0; s < observed.size(); ++s) {
    const Eigen::VectorXd residual = observed[s].response - observed[s].design * mean;
    log_likelihood -= 0.5 * residual.dot(units[s].precision * residual);
  }
}

}  // namespace mottle
