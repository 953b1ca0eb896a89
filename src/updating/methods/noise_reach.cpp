#include "updating/methods/noise_reach.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "updating/methods/least_squares.hpp"

namespace mottle::updating {
namespace {

/// f ~ outputs + slopes (u' - scores) of the parameters' scores.
struct Linearised {
  Eigen::VectorXd scores;
  Eigen::VectorXd outputs;
  Eigen::MatrixXd slopes;  // J
};

/// min over u of |V^-1/2 (e - J u)|^2 + |u|^2, where it is, and ln |V + J J'|.
struct Marginal {
  Eigen::VectorXd scores;
  double squares = 0.0;
  double log_determinant = 0.0;
};

class NoiseReach {
 public:
  NoiseReach(const UpdatingProblem& problem, const NoiseLevels& noise, const CommonLikelihood& likelihood,
             const RunContext& context, std::int64_t& evaluations)
      : problem_(problem), noise_(noise), likelihood_(likelihood), context_(context), evaluations_(evaluations) {}

  /// Gauss-Newton from the peak on, with noise of these levels.
  Linearised best(const PosteriorPeak& peak, const Eigen::VectorXd& levels) const {
    constexpr int k_steps = 8;
    constexpr int k_halvings = 4;
    constexpr double k_rest = 1e-10;
    const Eigen::VectorXd start = peak.scores.head(problem_.space.count());
    Linearised at{start, peak.outputs, peak.sensitivity * problem_.space.prior().standard_normal_derivatives(start)};
    for (int step = 0; step < k_steps; ++step) {
      const Eigen::VectorXd move = marginal(at, levels).scores - at.scores;
      double length = 1.0;
      for (int halving = 0; halving < k_halvings; ++halving, length *= 0.5) {
        const Eigen::VectorXd next = at.scores + length * move;
        const std::optional<Eigen::VectorXd> outputs = outputs_at(next);
        if (!outputs || !(cost(next, *outputs, levels) < cost(at.scores, at.outputs, levels))) continue;
        at = linearised(next, *outputs);
        break;
      }
      if (!(length * move.norm() > k_rest) || length < std::exp2(-k_halvings + 0.5)) break;
    }
    return at;
  }

  /// ln p(z | levels), up to a constant.
  double log_density(const Linearised& at, const Eigen::VectorXd& levels) const {
    const Marginal found = marginal(at, levels);
    const Eigen::VectorXd variances = noise_.variances(levels);
    double sum = found.squares + found.log_determinant;
    for (Eigen::Index k = 0; k < variances.size(); ++k) {
      const double count = likelihood_.count()(k);
      if (count > 1.0) sum += (count - 1.0) * std::log(variances(k)) + likelihood_.scatter()(k) / variances(k);
    }
    return -0.5 * sum;
  }

 private:
  Eigen::VectorXd variables(const Eigen::VectorXd& scores) const {
    return problem_.space.prior().from_standard_normal(scores.transpose()).row(0).transpose();
  }

  std::optional<Eigen::VectorXd> outputs_at(const Eigen::VectorXd& scores) const {
    const Eigen::VectorXd x = variables(scores);
    if (!are_possible(problem_.space, x.transpose()).front()) return std::nullopt;
    std::optional<Eigen::VectorXd> outputs = evaluate_one(problem_, x, context_, evaluations_);
    return outputs && outputs->allFinite() ? outputs : std::nullopt;
  }

  Linearised linearised(const Eigen::VectorXd& scores, const Eigen::VectorXd& outputs) const {
    const Eigen::VectorXd prior_std = problem_.space.prior().covariance().diagonal().cwiseSqrt();
    const Eigen::MatrixXd of_variables = model_jacobian(problem_, variables(scores), prior_std, context_, evaluations_);
    return {scores, outputs, of_variables * problem_.space.prior().standard_normal_derivatives(scores)};
  }

  /// Of the tests' means, 0 of what is not measured.
  Eigen::VectorXd precision_roots(const Eigen::VectorXd& levels) const {
    const Eigen::VectorXd variance = likelihood_.variance_of_mean(noise_.variances(levels));
    return (likelihood_.count().array() > 0.0).select(variance.cwiseInverse().cwiseSqrt(), 0.0);
  }

  double cost(const Eigen::VectorXd& scores, const Eigen::VectorXd& outputs, const Eigen::VectorXd& levels) const {
    return precision_roots(levels).cwiseProduct(likelihood_.mean() - outputs).squaredNorm() + scores.squaredNorm();
  }

  Marginal marginal(const Linearised& at, const Eigen::VectorXd& levels) const {
    const Eigen::VectorXd roots = precision_roots(levels);
    const Eigen::VectorXd apart = likelihood_.mean() - at.outputs + at.slopes * at.scores;
    const SingularValues svd(roots.asDiagonal() * at.slopes, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::ArrayXd s = svd.values().array();
    const Eigen::VectorXd along = svd.left().transpose() * roots.cwiseProduct(apart);
    Marginal found;
    found.scores = svd.right() * (s / (1.0 + s.square()) * along.array()).matrix();
    found.squares = roots.cwiseProduct(apart - at.slopes * found.scores).squaredNorm() + found.scores.squaredNorm();
    found.log_determinant = (1.0 + s.square()).log().sum();
    for (const double root : roots) found.log_determinant -= root > 0.0 ? 2.0 * std::log(root) : 0.0;
    return found;
  }

  const UpdatingProblem& problem_;
  const NoiseLevels& noise_;
  const CommonLikelihood& likelihood_;
  const RunContext& context_;
  std::int64_t& evaluations_;
};

double quantile_of(const Eigen::Ref<const Eigen::VectorXd>& column, double probability) {
  return quantile({column.begin(), column.end()}, probability, QuantileRule::ends);
}

/// How much more of the level k lies below quantiles of its draws than of these, by a sum over its scores: the most.
double missed_by_draws(const NoiseReach& reach, const NoiseLevels& noise, const Linearised& at,
                       const Eigen::VectorXd& medians, Eigen::Index k, const Eigen::Ref<const Eigen::VectorXd>& draws) {
  constexpr double k_first = -9.0;  // of the prior's scores: a level of 1e-19 of its scale
  constexpr double k_last = 6.0;
  constexpr double k_width = 0.02;
  std::vector<double> logs, levels;
  double largest = -std::numeric_limits<double>::infinity();
  Eigen::VectorXd all = medians;
  for (double score = k_first; score < k_last; score += k_width) {
    all(k) = noise.level(score);
    if (!(all(k) > 0.0)) continue;
    levels.push_back(all(k));
    logs.push_back(reach.log_density(at, all) - 0.5 * score * score);
    largest = std::isfinite(logs.back()) ? std::max(largest, logs.back()) : largest;
  }
  double most = 0.0;
  for (const double part : {0.005, 0.05, 0.25}) {
    const double end = quantile_of(draws, part);
    double below = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < logs.size(); ++i) {
      const double weight = std::isfinite(logs[i]) ? std::exp(logs[i] - largest) : 0.0;
      sum += weight;
      if (levels[i] < end) below += weight;
    }
    if (sum > 0.0) most = std::max(most, below / sum - part);
  }
  return most;
}

}  // namespace

std::vector<double> unreached_levels(const UpdatingProblem& problem, const NoiseLevels& noise,
                                     const CommonLikelihood& likelihood, const PosteriorPeak& peak,
                                     const Eigen::Ref<const Eigen::MatrixXd>& levels, const RunContext& context,
                                     std::int64_t& evaluations) {
  constexpr double k_lowest = 0.005;
  constexpr double k_far_below = 1e-3;
  std::vector<double> unreached(static_cast<std::size_t>(noise.count()), 0.0);
  const bool can_be_met = likelihood.count().sum() <= static_cast<double>(problem.space.count());
  if (noise.is_known() || can_be_met) return unreached;  // by any parameters: the density falls with the level then
  Eigen::VectorXd medians(noise.count()), lowest(noise.count());
  for (Eigen::Index k = 0; k < noise.count(); ++k) {
    medians(k) = quantile_of(levels.col(k), 0.5);
    lowest(k) = quantile_of(levels.col(k), k_lowest);
  }
  const NoiseReach reach(problem, noise, likelihood, context, evaluations);
  try {
    const Linearised at = reach.best(peak, k_far_below * lowest);
    for (Eigen::Index k = 0; k < noise.count(); ++k)
      unreached[static_cast<std::size_t>(k)] = missed_by_draws(reach, noise, at, medians, k, levels.col(k));
  } catch (const SystemFailure&) {  // the model fails about these parameters: nothing can be told
    return std::vector<double>(unreached.size(), 0.0);
  }
  return unreached;
}

}  // namespace mottle::updating
