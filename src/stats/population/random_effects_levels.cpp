#include "stats/population/random_effects_levels.hpp"

#include <Eigen/Core>

#include "mottle/linalg/dense/decompositions.hpp"
#include "stats/population/random_effects_step.hpp"

namespace mottle::stats {

LevelScores level_scores(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                         const RandomEffectsSettings& settings) {
  const RandomEffectsPass pass(units, fit.covariance, fit.noise_factors, at_levels(settings, fit.levels));
  const Eigen::Index errors = pass.shared.size();
  const auto own = pass.information.bottomRows(errors);
  Eigen::MatrixXd projected = own.rightCols(errors);  // E' P E
  if (pass.removed_variance.size() > 0) projected -= own * pass.removed_variance * own.transpose();
  Eigen::VectorXd weighed = Eigen::VectorXd::Zero(errors);  // E' P y
  for (const RandomEffectsPass::Unit& unit : pass.units) {
    weighed += (unit.shared_weighted * unit.residual).tail(errors);
  }
  Eigen::MatrixXd base = Eigen::MatrixXd::Zero(errors, settings.levels);
  for (Eigen::Index k = 0; k < errors; ++k) {
    const int level = settings.shared_level[static_cast<std::size_t>(k)];
    if (level >= 0) base(k, level) = settings.shared_variance(k);
  }
  return {.quadratic = base.transpose() * weighed.cwiseAbs2(),
          .trace = base.transpose() * projected.diagonal(),
          .information = base.transpose() * projected.cwiseAbs2() * base};
}

bool is_determined(const LevelScores& scores, const Eigen::VectorXd& levels, Eigen::Index level) {
  constexpr double k_min = 1e-6;  // degrees of freedom
  const double scale = levels(level) > 0.0 ? levels(level) : 1.0;
  return scores.trace(level) * scale > k_min;
}

Eigen::VectorXd scored_levels(const LevelScores& scores, const Eigen::VectorXd& levels) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index f = 0; f < levels.size(); ++f) {
    const bool is_held = levels(f) == 0.0 && scores.quadratic(f) <= scores.trace(f);
    if (is_determined(scores, levels, f) && !is_held) free.push_back(f);
  }
  Eigen::VectorXd next = levels;
  if (free.empty()) return next;
  const Eigen::MatrixXd information = scores.information(free, free);
  const Eigen::VectorXd slope = (scores.quadratic - scores.trace)(free);
  const Eigen::VectorXd step = solve_semidefinite(information, slope);
  next(free) += step;
  return next.cwiseMax(0.0);
}

}  // namespace mottle::stats
