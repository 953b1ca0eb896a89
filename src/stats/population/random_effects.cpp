#include "mottle/stats/population/random_effects.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "stats/population/random_effects_levels.hpp"
#include "stats/population/random_effects_step.hpp"

namespace mottle::stats {
namespace {

/// State of the iteration.
struct State {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd factors;
};

void keep_groups(Eigen::MatrixXd& covariance, const RandomEffectsSettings& settings) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      if (!may_be_correlated(settings, i, j)) covariance(i, j) = 0.0;
    }
  }
}

/// Positive definite, and not nearly singular, in the effects that have a variance.
bool is_positive(const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> scattered;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (covariance(i, i) != 0.0) scattered.push_back(i);
  }
  if (!covariance.allFinite() || (covariance.diagonal().array() < 0.0).any()) return false;
  Eigen::MatrixXd block = covariance(scattered, scattered);
  block.diagonal() *= 1.0 - static_cast<double>(block.rows()) * k_min_eigenvalue;
  return CholeskyFactor(block).is_positive_definite();
}

/// One step of expectation and maximisation.
State improve(const std::vector<RandomEffectsUnit>& units, const State& now, const RandomEffectsSettings& settings) {
  const RandomEffectsPass pass(units, now.covariance, now.factors, settings);
  const auto n = static_cast<double>(units.size());
  State next{Eigen::MatrixXd::Zero(now.covariance.rows(), now.covariance.cols()),
             Eigen::VectorXd::Zero(now.factors.size())};
  Eigen::MatrixXd removed = next.covariance;
  Eigen::VectorXd rows = next.factors;
  const bool removes = pass.removed_variance.size() > 0;
  for (std::size_t s = 0; s < units.size(); ++s) {
    const RandomEffectsPass::Unit& unit = pass.units[s];
    const Eigen::VectorXd& residual = unit.residual;
    const Eigen::VectorXd effect = now.covariance * (unit.weighted * residual);
    next.covariance += effect * effect.transpose();
    removed += unit.seen;
    if (removes) removed -= unit.seen_common() * pass.removed_variance * unit.common_seen();
    if (now.factors.size() == 0) continue;
    const Eigen::VectorXd weighed = unit.precision * residual;
    Eigen::MatrixXd projection = unit.precision;
    if (removes) projection -= unit.common_weighted().transpose() * pass.removed_variance * unit.common_weighted();
    for (Eigen::Index k = 0; k < residual.size(); ++k) {
      const int f = units[s].factor.empty() ? -1 : units[s].factor[static_cast<std::size_t>(k)];
      if (f < 0) continue;
      const double r = unit.noise(k);
      const double e = r * weighed(k);
      next.factors(f) += (e * e + r - r * r * projection(k, k)) / units[s].noise(k);
      rows(f) += 1.0;
    }
  }
  next.covariance += n * now.covariance - now.covariance * removed * now.covariance;
  const Eigen::VectorXd variances = next.covariance.diagonal() / n;
  next.covariance.diagonal() += settings.shrinkage * variances;
  next.covariance /= n + settings.shrinkage;
  next.covariance = (0.5 * (next.covariance + next.covariance.transpose())).eval();
  keep_groups(next.covariance, settings);
  // Where all scatter lies in fewer directions than there are effects, differences of nearly equal numbers leave
  // variances a little below zero, which further steps would carry on.
  if (!is_positive(next.covariance)) {
    repair_covariance(next.covariance, k_min_eigenvalue);
    keep_groups(next.covariance, settings);
  }
  next.factors = next.factors.cwiseQuotient(rows.cwiseMax(1.0)).cwiseMax(0.0);
  return next;
}

double largest_change(const State& before, const State& after) {
  const Eigen::VectorXd standard_deviation =
      before.covariance.diagonal().cwiseMax(after.covariance.diagonal()).cwiseSqrt();
  double change = 0.0;
  for (Eigen::Index i = 0; i < standard_deviation.size(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double scale = std::max(standard_deviation(i) * standard_deviation(j), 1e-300);
      change = std::max(change, std::abs(after.covariance(i, j) - before.covariance(i, j)) / scale);
    }
  }
  for (Eigen::Index f = 0; f < before.factors.size(); ++f) {
    change = std::max(change, std::abs(after.factors(f) / std::max(before.factors(f), 1e-300) - 1.0));
  }
  return change;
}

bool is_positive(const State& state) {
  return (state.factors.array() > 0.0).all() && is_positive(state.covariance);
}

/// Two steps and the squared extrapolation along them; the second step alone where the extrapolation is not admissible.
State accelerate(const State& start, const State& first, const State& second) {
  const auto norm = [](const State& a, const State& b) {
    const Eigen::VectorXd scale = a.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    return (scale.asDiagonal() * (b.covariance - a.covariance) * scale.asDiagonal()).squaredNorm() +
           ((b.factors - a.factors).array() / a.factors.array().max(1e-300)).square().sum();
  };
  const State bend{second.covariance - 2.0 * first.covariance + start.covariance,
                   second.factors - 2.0 * first.factors + start.factors};
  const State none{start.covariance, start.factors};
  const double r = norm(start, first);
  const double v = norm(none, {start.covariance + bend.covariance, start.factors + bend.factors});
  if (!(v > 0.0)) return second;
  for (double alpha = std::max(1.0, std::sqrt(r / v)); alpha > 1.0; alpha = alpha > 1.5 ? 0.5 * (alpha + 1.0) : 1.0) {
    State leap{start.covariance + 2.0 * alpha * (first.covariance - start.covariance) + alpha * alpha * bend.covariance,
               start.factors + 2.0 * alpha * (first.factors - start.factors) + alpha * alpha * bend.factors};
    if (is_positive(leap)) return leap;
  }
  return second;
}

void require_units(const std::vector<RandomEffectsUnit>& units, Eigen::Index effects) {
  require(units.size() >= 2, "random effects: {} unit has no scatter; at least 2 are needed", units.size());
  for (const RandomEffectsUnit& unit : units) {
    require(unit.design.cols() == effects && unit.design.rows() == unit.response.size() &&
                unit.noise.size() == unit.response.size() &&
                (unit.factor.empty() || static_cast<Eigen::Index>(unit.factor.size()) == unit.response.size()),
            "random effects: a unit's design is {} x {}, its response has {} rows and its noise {}, for {} effects",
            unit.design.rows(), unit.design.cols(), unit.response.size(), unit.noise.size(), effects);
  }
}

void require_shared(const std::vector<RandomEffectsUnit>& units, const RandomEffectsSettings& settings) {
  const Eigen::Index errors = settings.shared_variance.size();
  require(settings.shared_level.empty() || static_cast<Eigen::Index>(settings.shared_level.size()) == errors,
          "random effects: {} levels are named for {} shared errors", settings.shared_level.size(), errors);
  for (const RandomEffectsUnit& unit : units) {
    require(unit.shared.size() == 0 || (unit.shared.rows() == unit.response.size() && unit.shared.cols() == errors),
            "random effects: a unit of {} rows has a design of {} x {} for {} shared errors", unit.response.size(),
            unit.shared.rows(), unit.shared.cols(), errors);
  }
}

/// The estimate at known variances of the shared errors.
RandomEffectsFit fit_at(const std::vector<RandomEffectsUnit>& units, const Eigen::Ref<const Eigen::MatrixXd>& start,
                        const RandomEffectsSettings& settings) {
  State state{start, Eigen::VectorXd::Ones(settings.factors)};
  keep_groups(state.covariance, settings);
  RandomEffectsFit fit;
  while (fit.iterations < settings.iterations && !fit.converged) {
    const State first = improve(units, state, settings);
    const State second = improve(units, first, settings);
    fit.iterations += 3;
    if (largest_change(first, second) <= settings.tolerance) {
      state = second;
      fit.converged = true;
      break;
    }
    const State leap = accelerate(state, first, second);
    const State next = improve(units, leap, settings);
    state = is_positive(next) ? next : second;
  }
  const RandomEffectsPass pass(units, state.covariance, state.factors, settings);
  fit.mean = pass.mean;
  fit.covariance = state.covariance;
  fit.noise_factors = state.factors;
  fit.shared = pass.shared;
  fit.log_likelihood = pass.log_likelihood;
  fit.effects.resize(static_cast<Eigen::Index>(units.size()), start.rows());
  for (std::size_t s = 0; s < units.size(); ++s) {
    fit.effects.row(static_cast<Eigen::Index>(s)) =
        (pass.mean + state.covariance * (pass.units[s].weighted * pass.units[s].residual)).transpose();
  }
  return fit;
}

}  // namespace

RandomEffectsFit fit_random_effects(const std::vector<RandomEffectsUnit>& units,
                                    const Eigen::Ref<const Eigen::MatrixXd>& start,
                                    const RandomEffectsSettings& settings) {
  require_units(units, start.rows());
  require_shared(units, settings);
  Eigen::VectorXd levels = Eigen::VectorXd::Ones(settings.levels);
  RandomEffectsFit fit = fit_at(units, start, at_levels(settings, levels));
  constexpr int k_max_rounds = 30;
  for (int round = 0; round < k_max_rounds && settings.levels > 0; ++round) {
    // Sigma hardly depends on the levels: where designs are alike, not at all.
    fit.levels = levels;
    const Eigen::VectorXd next = scored_levels(level_scores(units, fit, settings), levels);
    const double change = ((next - levels).array() / next.cwiseMax(levels).array().max(1e-300)).abs().maxCoeff();
    levels = next;
    const int iterations = fit.iterations;
    fit = fit_at(units, fit.covariance, at_levels(settings, levels));
    fit.iterations += iterations;
    if (change <= std::sqrt(settings.tolerance)) break;
  }
  fit.levels = levels;
  return fit;
}

}  // namespace mottle::stats
