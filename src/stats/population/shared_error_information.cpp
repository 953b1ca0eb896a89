// Estimates of the errors that all units share, at a fit.
#include <algorithm>

#include "stats/population/random_effects_levels.hpp"
#include "stats/population/random_effects_step.hpp"

namespace mottle::stats {
namespace {

SharedErrorLevel level_evidence(const LevelScores& scores, const Eigen::VectorXd& levels, Eigen::Index level) {
  if (!is_determined(scores, levels, level)) return {};
  const double trace = scores.trace(level);
  const double own = scores.information(level, level);
  double common = 0.0;  // squared correlation of its estimate with those of the other levels, the largest
  for (Eigen::Index other = 0; other < levels.size(); ++other) {
    const double product = own * scores.information(other, other);
    if (other == level || !(product > 0.0)) continue;
    common = std::max(common, scores.information(level, other) * scores.information(level, other) / product);
  }
  return {.observed = scores.quadratic(level) / own,
          .known = std::max(trace / own - levels(level), 0.0),
          .degrees_of_freedom = trace * trace / own * (1.0 - std::min(common, 1.0))};
}

}  // namespace

SharedErrorInformation shared_error_information(const std::vector<RandomEffectsUnit>& units,
                                                const RandomEffectsFit& fit, const RandomEffectsSettings& settings) {
  const RandomEffectsPass pass(units, fit.covariance, fit.noise_factors, at_levels(settings, fit.levels));
  RandomEffectsSettings without = settings;
  without.shared_variance.setZero();
  const RandomEffectsPass apart(units, fit.covariance, fit.noise_factors, at_levels(without, fit.levels));
  const Eigen::Index q = fit.mean.size();
  const Eigen::Index errors = pass.shared.size();
  SharedErrorInformation result;
  result.covariance = pass.common_variance.bottomRightCorner(errors, errors);
  result.gain = -apart.common_variance.topLeftCorner(q, q) * pass.information.topRightCorner(q, errors);
  result.sensitivity = pass.common_variance.topRows(q) * pass.information.rightCols(errors);
  if (settings.levels == 0) return result;
  const LevelScores scores = level_scores(units, fit, settings);
  for (Eigen::Index level = 0; level < settings.levels; ++level) {
    result.levels.push_back(level_evidence(scores, fit.levels, level));
  }
  return result;
}

}  // namespace mottle::stats
