#include "stats/population/effect_evidence.hpp"

#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "stats/population/random_effects_step.hpp"

namespace mottle::stats {

ScatterRoot scatter_root(const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  constexpr double k_no_scatter = 10.0 * k_min_eigenvalue;
  const Eigen::VectorXd standard_deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd scale = (standard_deviation.array() > 0.0).select(standard_deviation.cwiseInverse(), 0.0);
  const SymmetricEigen solver(scale.asDiagonal() * covariance * scale.asDiagonal());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < standard_deviation.size(); ++k) {
    if (solver.eigenvalues()(k) > k_no_scatter * solver.eigenvalues().maxCoeff()) kept.push_back(k);
  }
  const Eigen::MatrixXd vectors = solver.eigenvectors()(Eigen::all, kept);
  const Eigen::VectorXd lengths = solver.eigenvalues()(kept).cwiseSqrt();
  return {standard_deviation.asDiagonal() * vectors * lengths.asDiagonal(),
          lengths.cwiseInverse().asDiagonal() * vectors.transpose() * scale.asDiagonal()};
}

WhitenedEffects whiten_effects(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit) {
  constexpr double k_smallest_noise = 1e-14;  // of the row's variance: rows without noise count alike
  WhitenedEffects effects{scatter_root(fit.covariance).root, {}};
  for (const RandomEffectsUnit& unit : units) {
    const Eigen::VectorXd noise = noise_of(unit, fit.noise_factors);
    const Eigen::MatrixXd moved = unit.design * effects.root;
    const Eigen::VectorXd smallest = k_smallest_noise * moved.rowwise().squaredNorm();
    const Eigen::VectorXd weight = noise.cwiseMax(smallest).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = weight.asDiagonal() * moved;
    const Eigen::VectorXd response = weight.asDiagonal() * (unit.response - unit.design * fit.mean);
    const Eigen::MatrixXd scaled_noise = noise.cwiseProduct(weight.cwiseAbs2()).asDiagonal();
    if (scaled.rows() <= scaled.cols()) {
      effects.specimens.push_back({scaled, scaled_noise, response});
      continue;
    }
    const Eigen::MatrixXd q = orthonormal_columns(scaled);
    effects.specimens.push_back({q.transpose() * scaled, q.transpose() * scaled_noise * q, q.transpose() * response});
  }
  return effects;
}

CholeskyFactor positive_factor(Eigen::MatrixXd matrix) {
  constexpr double k_floor = 1e-12;
  if (matrix.size() == 0) return CholeskyFactor(matrix);
  const double lowest = k_floor * std::max(matrix.diagonal().maxCoeff(), 1e-280);
  matrix.diagonal() += k_floor * matrix.diagonal().cwiseMax(lowest);
  CholeskyFactor factor(matrix);
  for (double lift = k_floor; !factor.is_positive_definite(); lift *= 10.0) {
    matrix.diagonal().array() += lift * std::max(matrix.diagonal().maxCoeff(), 1e-300);
    factor = CholeskyFactor(matrix);
  }
  return factor;
}

ShrunkenEffects shrink_effects(const std::vector<EffectEvidence>& specimens, const Eigen::VectorXd& mean,
                               const Eigen::MatrixXd& covariance) {
  ShrunkenEffects shrunken{Eigen::MatrixXd(static_cast<Eigen::Index>(specimens.size()), mean.size()), {}};
  for (std::size_t s = 0; s < specimens.size(); ++s) {
    const EffectEvidence& own = specimens[s];
    const Eigen::MatrixXd moved = own.design * covariance;
    const CholeskyFactor factor = positive_factor(moved * own.design.transpose() + own.noise);
    shrunken.spreads.emplace_back(factor.solve_lower(moved).transpose());
    const Eigen::VectorXd whitened = factor.solve_lower(own.response - own.design * mean);
    shrunken.points.row(static_cast<Eigen::Index>(s)) = (shrunken.spreads.back() * whitened).transpose();
  }
  return shrunken;
}

Eigen::MatrixXd ShrunkenEffects::along(const Eigen::Ref<const Eigen::MatrixXd>& axes) const {
  return points * axes.transpose();
}

Eigen::MatrixXd ShrunkenEffects::standard_deviations(const Eigen::Ref<const Eigen::MatrixXd>& axes) const {
  Eigen::MatrixXd standard_deviations(points.rows(), axes.rows());
  for (std::size_t s = 0; s < spreads.size(); ++s) {
    standard_deviations.row(static_cast<Eigen::Index>(s)) = (axes * spreads[s]).rowwise().norm().transpose();
  }
  return standard_deviations;
}

std::optional<Eigen::MatrixXd> alike_estimates(const WhitenedEffects& effects, double likeness) {
  constexpr double k_determined = 1e-10;
  const Eigen::Index directions = effects.root.cols();
  Eigen::MatrixXd estimates(static_cast<Eigen::Index>(effects.specimens.size()), directions);
  std::vector<Eigen::MatrixXd> noises;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(directions, directions);
  for (std::size_t s = 0; s < effects.specimens.size(); ++s) {
    const EffectEvidence& own = effects.specimens[s];
    if (own.design.rows() < directions) return std::nullopt;
    const PivotedQr factor(own.design, k_determined);
    if (factor.rank() < directions) return std::nullopt;
    const Eigen::MatrixXd inverse = factor.inverse();
    estimates.row(static_cast<Eigen::Index>(s)) = (inverse * own.response).transpose();
    noises.emplace_back(inverse * own.noise * inverse.transpose());
    mean += noises.back() / static_cast<double>(effects.specimens.size());
  }
  for (const Eigen::MatrixXd& noise : noises) {
    if ((noise - mean).norm() > likeness) return std::nullopt;
  }
  return estimates;
}

}  // namespace mottle::stats
