// The evidence of a random-effects fit on the population, expressed as an equivalent sample covariance with degrees of
// freedom.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/population/population_intervals.hpp"

namespace mottle::stats {
namespace {

/// Generalised least-squares estimate of one unit's effects and its covariance; nothing where it is not determined.
struct OwnEstimate {
  Eigen::VectorXd effects;
  Eigen::MatrixXd noise;
  bool is_determined = false;
};

OwnEstimate own_estimate(const RandomEffectsUnit& unit, const Eigen::VectorXd& factors, const Eigen::MatrixXd& sigma) {
  constexpr double k_determined = 1e-10;
  constexpr double k_smallest_noise = 1e-14;  // of the row's variance: rows without noise count alike
  OwnEstimate result;
  if (unit.design.cols() == 0 || unit.design.rows() < unit.design.cols()) return result;
  const Eigen::VectorXd noise = noise_of(unit, factors);
  const Eigen::VectorXd scatter = (unit.design * sigma * unit.design.transpose()).diagonal();
  const Eigen::VectorXd weight = noise.cwiseMax(k_smallest_noise * scatter).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd standard_deviation = sigma.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd scaled = weight.asDiagonal() * unit.design * standard_deviation.asDiagonal();
  const SingularValues svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.values();
  if (!(values.minCoeff() > k_determined * values.maxCoeff())) return result;
  const Eigen::MatrixXd inverse = standard_deviation.asDiagonal() * svd.right() * values.cwiseInverse().asDiagonal() *
                                  svd.left().transpose() * weight.asDiagonal();
  result.effects = inverse * unit.response;
  result.noise = inverse * noise.asDiagonal() * inverse.transpose();
  result.is_determined = true;
  return result;
}

/// The evidence of units that each determine their own effects, none of them much worse than the others.
bool gather_balanced(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                     const Eigen::Ref<const Eigen::MatrixXd>& map, PopulationEvidence& evidence) {
  const auto n = static_cast<Eigen::Index>(units.size());
  Eigen::MatrixXd estimates(n, map.rows());
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(map.rows(), map.rows());
  Eigen::VectorXd worst = Eigen::VectorXd::Zero(map.rows());
  for (Eigen::Index s = 0; s < n; ++s) {
    const OwnEstimate own = own_estimate(units[static_cast<std::size_t>(s)], fit.noise_factors, fit.covariance);
    if (!own.is_determined) return false;
    estimates.row(s) = (map * own.effects).transpose();
    const Eigen::MatrixXd own_noise = map * own.noise * map.transpose();
    noise += own_noise / static_cast<double>(n);
    worst = worst.cwiseMax(own_noise.diagonal());
  }
  constexpr double k_small = 0.25;  // part of Sigma: so little noise need not be alike
  constexpr double k_alike = 4.0;
  const Eigen::VectorXd sigma = (map * fit.covariance * map.transpose()).diagonal();
  for (Eigen::Index i = 0; i < map.rows(); ++i) {
    if (worst(i) > k_alike * noise(i, i) && worst(i) > k_small * sigma(i)) return false;
  }
  const Eigen::MatrixXd total = sample_covariance(estimates);
  evidence.total = total;
  evidence.noise = noise;
  evidence.mean_covariance = total / static_cast<double>(n);
  evidence.degrees_of_freedom = Eigen::MatrixXd::Constant(map.rows(), map.rows(), static_cast<double>(n - 1));
  return true;
}

/// Degrees of freedom of an entry from its sampling variance; `spread` is the variance at one degree of freedom.
double entry_degrees_of_freedom(double spread, double variance, double units) {
  const double complete = units - 1.0;
  const double expected = std::min(spread / std::max(variance, 1e-300), complete);
  constexpr double k_min = 0.5;
  constexpr double k_small_sample = 3.0;  // chosen by replication at 5 to 50 specimens (validation/population)
  if (expected > complete * (1.0 - 1e-6)) return complete;
  return std::max(expected * units / (units + k_small_sample), k_min);
}

/// Errors that all units share move the mean alone.
void add_shared_errors(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                       const RandomEffectsSettings& settings, const Eigen::Ref<const Eigen::MatrixXd>& map,
                       PopulationEvidence& evidence) {
  if (settings.shared_variance.isZero(0.0)) return;
  const SharedErrorInformation shared = shared_error_information(units, fit, settings);
  const Eigen::MatrixXd gain = map * shared.gain;
  evidence.mean_shared = gain * shared.covariance * gain.transpose();
  evidence.mean_covariance += evidence.mean_shared;
  for (std::size_t level = 0; level < shared.levels.size(); ++level) {
    Eigen::VectorXd variance = settings.shared_variance;
    for (std::size_t k = 0; k < settings.shared_level.size(); ++k) {
      if (settings.shared_level[k] != static_cast<int>(level)) variance(static_cast<Eigen::Index>(k)) = 0.0;
    }
    const Eigen::MatrixXd moved = map * shared.sensitivity;
    evidence.levels.emplace_back(moved * variance.asDiagonal() * moved.transpose(), shared.levels[level]);
  }
}

}  // namespace

PopulationEvidence population_evidence(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                                       const RandomEffectsSettings& settings,
                                       const Eigen::Ref<const Eigen::MatrixXd>& map) {
  PopulationEvidence evidence;
  evidence.mean = map * fit.mean;
  if (map.cols() == 0) {  // the outputs see nothing
    evidence.total = Eigen::MatrixXd::Zero(map.rows(), map.rows());
    evidence.noise = evidence.mean_covariance = evidence.degrees_of_freedom = evidence.total;
    return evidence;
  }
  if (settings.covariance_groups.empty() && settings.mean_origin.size() == 0 &&
      gather_balanced(units, fit, map, evidence)) {
    add_shared_errors(units, fit, settings, map, evidence);
    return evidence;
  }
  const RandomEffectsInformation information = random_effects_information(units, fit, settings);
  const Eigen::MatrixXd from_effects = map * information.mean_from_effects * map.transpose();
  const Eigen::MatrixXd from_noise = map * information.mean_from_noise * map.transpose();
  const Eigen::MatrixXd sigma = map * fit.covariance * map.transpose();
  const Eigen::VectorXd ratio =
      (sigma.diagonal().array() / from_effects.diagonal().array().max(1e-300)).max(0.0).sqrt();
  evidence.noise = ratio.asDiagonal() * from_noise * ratio.asDiagonal();
  evidence.total = sigma + evidence.noise;
  evidence.mean_covariance = from_effects + from_noise;
  evidence.degrees_of_freedom = Eigen::MatrixXd::Zero(map.rows(), map.rows());
  const auto n = static_cast<double>(units.size());
  for (Eigen::Index i = 0; i < map.rows(); ++i) {
    for (Eigen::Index j = 0; j < map.rows(); ++j) {
      const double t = evidence.total(i, j);
      const double spread = t * t + evidence.total(i, i) * evidence.total(j, j);
      const double variance = information.variance_of(map.row(i).transpose(), map.row(j).transpose());
      evidence.degrees_of_freedom(i, j) = variance > 0.0 ? entry_degrees_of_freedom(spread, variance, n) : 0.0;
    }
  }
  add_shared_errors(units, fit, settings, map, evidence);
  return evidence;
}

}  // namespace mottle::stats
