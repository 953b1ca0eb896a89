#include "stats/population/random_effects_step.hpp"

#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {
namespace {

/// C^-1 and log det C of a covariance that may be singular to rounding: 1e-13 of its diagonal is added.
std::pair<Eigen::MatrixXd, double> invert(Eigen::MatrixXd covariance) {
  constexpr double k_floor = 1e-13;
  covariance.diagonal() *= 1.0 + k_floor;
  constexpr double k_no_variance = 1e-200;  // its inverse, and products of that, are still numbers
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(k_no_variance).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  if (!scaled.allFinite()) throw ModelFailure("random effects: the covariance of a unit is not finite");
  CholeskyFactor factor(scaled);
  for (double lift = k_floor; !factor.is_positive_definite(); lift *= 10.0) {
    factor = CholeskyFactor(scaled + lift * Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  }
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  const double log_det = factor.log_determinant() - 2.0 * scale.array().log().sum();
  return {scale.asDiagonal() * inverse * scale.asDiagonal(), log_det};
}

}  // namespace

Eigen::VectorXd noise_of(const RandomEffectsUnit& unit, const Eigen::VectorXd& factors) {
  Eigen::VectorXd noise = unit.noise;
  for (std::size_t k = 0; k < unit.factor.size(); ++k) {
    if (unit.factor[k] >= 0) noise(static_cast<Eigen::Index>(k)) *= factors(unit.factor[k]);
  }
  return noise;
}

RandomEffectsSettings at_levels(const RandomEffectsSettings& settings, const Eigen::VectorXd& levels) {
  RandomEffectsSettings known = settings;
  for (std::size_t k = 0; k < settings.shared_level.size(); ++k) {
    const int level = settings.shared_level[k];
    if (level >= 0) known.shared_variance(static_cast<Eigen::Index>(k)) *= levels(level);
  }
  known.shared_level.clear();
  known.levels = 0;
  return known;
}

RandomEffectsPass::Unit RandomEffectsPass::make_unit(const RandomEffectsUnit& from, const Eigen::MatrixXd& covariance,
                                                     const Eigen::VectorXd& factors) {
  Unit unit;
  unit.noise = noise_of(from, factors);
  Eigen::MatrixXd total = from.design * covariance * from.design.transpose();
  total.diagonal() += unit.noise;
  double log_det = 0.0;
  std::tie(unit.precision, log_det) = invert(std::move(total));
  unit.weighted = from.design.transpose() * unit.precision;
  unit.seen = unit.weighted * from.design;
  log_likelihood -= 0.5 * log_det;
  unit.has_shared = shared.size() > 0;
  if (!unit.has_shared) return unit;
  const Eigen::Index q = covariance.rows();
  unit.shared_weighted = Eigen::MatrixXd::Zero(q + shared.size(), from.design.rows());
  unit.shared_weighted.topRows(q) = unit.weighted;
  if (from.shared.size() > 0) unit.shared_weighted.bottomRows(shared.size()) = from.shared.transpose() * unit.precision;
  unit.shared_seen = unit.shared_weighted * from.design;
  unit.seen_shared = unit.shared_seen.transpose();
  return unit;
}

RandomEffectsPass::RandomEffectsPass(const std::vector<RandomEffectsUnit>& observed, const Eigen::MatrixXd& covariance,
                                     const Eigen::VectorXd& factors, const RandomEffectsSettings& settings)
    : shared(Eigen::VectorXd::Zero(settings.shared_variance.size())) {
  const Eigen::Index q = covariance.rows();
  const Eigen::Index common = q + shared.size();
  mean = settings.mean_origin.size() == q ? settings.mean_origin : Eigen::VectorXd(Eigen::VectorXd::Zero(q));
  information = Eigen::MatrixXd::Zero(common, common);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(common);
  units.reserve(observed.size());
  for (const RandomEffectsUnit& from : observed) {
    units.push_back(make_unit(from, covariance, factors));
    const Unit& unit = units.back();
    information.leftCols(q) += unit.common_seen();
    if (unit.has_shared && from.shared.size() > 0) {
      information.rightCols(shared.size()) += unit.shared_weighted * from.shared;
    }
    gradient += unit.common_weighted() * (from.response - from.design * mean);
  }
  solve_common(settings, gradient);
  for (std::size_t s = 0; s < observed.size(); ++s) {
    Unit& unit = units[s];
    unit.residual = observed[s].response - observed[s].design * mean;
    if (unit.has_shared && observed[s].shared.size() > 0) unit.residual -= observed[s].shared * shared;
    log_likelihood -= 0.5 * unit.residual.dot(unit.precision * unit.residual);
  }
}

/// Shared errors are solved for in their standard deviations, d = D^1/2 u, u ~ N(0, I): an error of zero has no effect.
void RandomEffectsPass::solve_common(const RandomEffectsSettings& settings, const Eigen::VectorXd& gradient) {
  const Eigen::Index q = mean.size();
  const Eigen::Index errors = shared.size();
  const Eigen::MatrixXd directions =
      settings.mean_origin.size() == q ? settings.mean_directions : Eigen::MatrixXd(Eigen::MatrixXd::Identity(q, q));
  const Eigen::Index estimated = directions.cols();
  const Eigen::VectorXd standard_deviation = settings.shared_variance.cwiseSqrt();
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(q + errors, estimated + errors);
  basis.topLeftCorner(q, estimated) = directions;
  basis.bottomRightCorner(errors, errors) = standard_deviation.asDiagonal();
  common_variance = Eigen::MatrixXd::Zero(q + errors, q + errors);
  if (basis.cols() > 0) {
    Eigen::MatrixXd equations = basis.transpose() * information * basis;
    equations.diagonal().tail(errors).array() += 1.0;
    const auto [inverse, log_det] = invert(equations);
    common_variance = basis * inverse * basis.transpose();
    if (settings.is_restricted) log_likelihood -= 0.5 * log_det;
    if (!settings.is_restricted && errors > 0) {
      const auto [own_inverse, own_log_det] = invert(equations.bottomRightCorner(errors, errors));
      removed_variance = Eigen::MatrixXd::Zero(q + errors, q + errors);
      removed_variance.bottomRightCorner(errors, errors) =
          standard_deviation.asDiagonal() * own_inverse * standard_deviation.asDiagonal();
      log_likelihood -= 0.5 * own_log_det;
    }
  }
  if (settings.is_restricted) removed_variance = common_variance;
  const Eigen::VectorXd solution = common_variance * gradient;
  mean += solution.head(q);
  shared = solution.tail(errors);
  const Eigen::ArrayXd standardised = shared.array() / standard_deviation.array().max(1e-300);
  log_likelihood -= 0.5 * standardised.square().sum();
}

}  // namespace mottle::stats
