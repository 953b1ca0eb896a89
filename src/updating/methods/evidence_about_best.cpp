#include "updating/methods/evidence_about_best.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/chains/leave_one_out.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "updating/estimate/normal_draws.hpp"
#include "updating/sampling/normal_mixture.hpp"

namespace mottle::updating {
namespace {

constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();
constexpr Eigen::Index k_draws = 2000;
constexpr double k_first = -9.0;  // of a level's scores: 1e-19 of the prior's scale
constexpr double k_last = 6.0;
constexpr double k_width = 0.02;

/// Directions of the measured outputs, each relative to its size, that the parameters' scores move.
Eigen::Index movable_directions(const UpdatingProblem& problem, const CommonLikelihood& likelihood,
                                const PosteriorPeak& peak) {
  constexpr double k_unseen = 1e-6;  // of the most that is moved
  const Eigen::MatrixXd slopes =
      peak.sensitivity * problem.space.prior().standard_normal_derivatives(peak.scores.head(problem.space.count()));
  const Eigen::VectorXd sizes = likelihood.mean().cwiseAbs();
  const Eigen::VectorXd weights =
      (likelihood.count().array() > 0.0 && sizes.array() > 0.0).select(sizes.cwiseInverse(), 0.0);
  return PivotedQr(weights.asDiagonal() * slopes, k_unseen).rank();
}

double quantile_of(const Eigen::Ref<const Eigen::VectorXd>& column, double probability) {
  return quantile({column.begin(), column.end()}, probability, QuantileRule::ends);
}

/// Probabilities of a level's scores in cells of k_width, by linear theory with the other levels at their medians.
using LevelGrid = std::vector<double>;

LevelGrid make_grid(const LinearNoise& linear, const NoiseLevels& noise, const Linearised& at,
                    const Eigen::VectorXd& medians, Eigen::Index k) {
  LevelGrid grid;
  Eigen::VectorXd all = medians;
  double largest = k_minus_infinity;
  const int cells = static_cast<int>(std::lround((k_last - k_first) / k_width));
  for (int cell = 0; cell < cells; ++cell) {
    const double score = k_first + (cell + 0.5) * k_width;
    all(k) = noise.level(score);
    const double log_density = all(k) > 0.0 ? linear.log_density(at, all) - 0.5 * score * score : k_minus_infinity;
    grid.push_back(std::isfinite(log_density) ? log_density : k_minus_infinity);
    largest = std::max(largest, grid.back());
  }
  double sum = 0.0;
  for (double& value : grid) sum += value = std::exp(value - largest);
  for (double& value : grid) value /= sum;
  return grid;
}

double log_normal_density(double score) {
  return -0.5 * (score * score + std::log(2.0 * std::numbers::pi));
}

/// Draws of scores about one set of best parameters.
class ReachingDraws {
 public:
  ReachingDraws(const LinearNoise& linear, const NoiseLevels& noise, Linearised at, std::vector<LevelGrid> grids)
      : linear_(linear), noise_(noise), at_(std::move(at)), grids_(std::move(grids)) {}

  Eigen::VectorXd draw(RandomStream& random) const {
    Eigen::VectorXd scores(static_cast<Eigen::Index>(grids_.size()));
    for (Eigen::Index k = 0; k < scores.size(); ++k) {
      scores(k) = draw_level(grids_[static_cast<std::size_t>(k)], random);
    }
    const LinearPosterior given = linear_.given(at_, levels_of(scores));
    const Eigen::VectorXd normal = standard_normals(random, given.scores.size());
    const double chi_squared = standard_normals(random, static_cast<Eigen::Index>(k_nu)).squaredNorm();
    const Eigen::VectorXd t = normal * std::sqrt(k_nu / chi_squared);
    Eigen::VectorXd point(given.scores.size() + scores.size());
    point << given.scores + given.axes * given.deviations.cwiseProduct(t), scores;
    return point;
  }

  /// Of what draws are drawn from.
  double log_density(const Eigen::VectorXd& point) const {
    const auto levels = static_cast<Eigen::Index>(grids_.size());
    const Eigen::VectorXd scores = point.tail(levels);
    double sum = 0.0;
    for (Eigen::Index k = 0; k < levels; ++k) sum += log_level_density(grids_[static_cast<std::size_t>(k)], scores(k));
    const LinearPosterior given = linear_.given(at_, levels_of(scores));
    const auto q = static_cast<double>(given.scores.size());
    const Eigen::VectorXd t =
        (given.axes.transpose() * (point.head(given.scores.size()) - given.scores)).cwiseQuotient(given.deviations);
    return sum + log_t_constant(k_nu, q) - given.deviations.array().log().sum() -
           0.5 * (k_nu + q) * std::log1p(t.squaredNorm() / k_nu);
  }

 private:
  static constexpr double k_nu = 5.0;
  static constexpr double k_of_prior = 0.1;

  Eigen::VectorXd levels_of(const Eigen::VectorXd& scores) const {
    return scores.unaryExpr([this](double score) { return noise_.level(score); });
  }

  static double draw_level(const LevelGrid& grid, RandomStream& random) {
    const double kind = random.uniform(), place = random.uniform(), inside = random.uniform();
    if (kind < k_of_prior) return standard_normal_quantile(place);
    std::size_t cell = 0;
    for (double sum = grid[0]; sum < place && cell + 1 < grid.size();) sum += grid[++cell];
    return k_first + (static_cast<double>(cell) + inside) * k_width;
  }

  static double log_level_density(const LevelGrid& grid, double score) {
    const auto cell = static_cast<std::ptrdiff_t>(std::floor((score - k_first) / k_width));
    const bool is_inside = cell >= 0 && cell < std::ssize(grid);
    const double of_grid = is_inside ? grid[static_cast<std::size_t>(cell)] / k_width : 0.0;
    return std::log((1.0 - k_of_prior) * of_grid + k_of_prior * std::exp(log_normal_density(score)));
  }

  const LinearNoise& linear_;
  const NoiseLevels& noise_;
  Linearised at_;
  std::vector<LevelGrid> grids_;
};

/// About every set in turn, with the density of their mixture.
Eigen::VectorXd draw_mixed(const std::vector<ReachingDraws>& sets, std::size_t number, RandomStream& random,
                           double& log_density) {
  Eigen::VectorXd point = sets[number % sets.size()].draw(random);
  Eigen::VectorXd logs(static_cast<Eigen::Index>(sets.size()));
  for (std::size_t m = 0; m < sets.size(); ++m) logs(static_cast<Eigen::Index>(m)) = sets[m].log_density(point);
  log_density = logs.maxCoeff() + std::log((logs.array() - logs.maxCoeff()).exp().mean());
  return point;
}

RandomStream stream_of(const RunContext& context, Eigen::Index number) {
  // Islands begin at stage 1: these are free.
  return {{.seed = context.seed, .purpose = StreamPurpose::posterior_proposal, .iteration = 0},
          static_cast<std::uint32_t>(number)};
}

constexpr Eigen::Index k_prior_draws = 20000;

/// The share of draws of the prior that are possible.
double possible_share(const SamplingTarget& target, const RunContext& context) {
  if (!target.is_possible) return 1.0;
  Eigen::MatrixXd points(k_prior_draws, target.dimension);
  for (Eigen::Index i = 0; i < k_prior_draws; ++i) {
    RandomStream random = stream_of(context, k_draws + i);
    points.row(i) = standard_normals(random, target.dimension).transpose();
  }
  const std::vector<bool> possible = target.is_possible(points);
  return static_cast<double>(std::ranges::count(possible, true)) / static_cast<double>(k_prior_draws);
}

std::optional<EvidenceAboutBest> importance_evidence(const std::vector<ReachingDraws>& sets,
                                                     const SamplingTarget& target, const RunContext& context) {
  Eigen::MatrixXd points(k_draws, target.dimension);
  Eigen::VectorXd log_weights(k_draws);
  for (Eigen::Index i = 0; i < k_draws; ++i) {
    RandomStream random = stream_of(context, i);
    double log_density = 0.0;
    points.row(i) = draw_mixed(sets, static_cast<std::size_t>(i), random, log_density).transpose();
    log_weights(i) = -log_density;
    for (const double score : points.row(i)) log_weights(i) += log_normal_density(score);
  }
  const std::vector<bool> possible = target.is_possible ? target.is_possible(points) : std::vector<bool>(k_draws, true);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < k_draws; ++i) {
    if (possible[static_cast<std::size_t>(i)]) rows.push_back(i);
  }
  const double share = possible_share(target, context);
  if (rows.empty() || !(share > 0.0)) return std::nullopt;
  Eigen::ArrayXd logs = Eigen::ArrayXd::Constant(k_draws, k_minus_infinity);
  logs(rows) = (log_weights(rows) + target.log_likelihood(points(rows, Eigen::all))).unaryExpr([](double value) {
    return std::isnan(value) ? k_minus_infinity : value;
  });
  const double largest = logs.maxCoeff();
  if (!std::isfinite(largest)) return std::nullopt;
  const Eigen::ArrayXd weights = (logs - largest).exp();
  const auto n = static_cast<double>(k_draws);
  const double mean = weights.sum() / n;
  const double variance = weights.square().sum() / n - mean * mean;
  const double of_share = (1.0 - share) / (share * static_cast<double>(k_prior_draws));
  return EvidenceAboutBest{{.log_evidence = largest + std::log(mean) - std::log(share),
                            .standard_error = std::sqrt(variance / n / (mean * mean) + of_share),
                            .degrees_of_freedom = n - 1.0},
                           pareto_k_of(logs)};
}

}  // namespace

std::optional<EvidenceAboutBest> evidence_about_best(const UpdatingProblem& problem, const NoiseLevels& noise,
                                                     const CommonLikelihood& likelihood,
                                                     const std::vector<PosteriorPeak>& peaks,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& levels,
                                                     const SamplingTarget& target, const RunContext& context,
                                                     std::int64_t& evaluations) {
  constexpr double k_lowest = 0.005;
  constexpr double k_far_below = 1e-3;
  // What parameters can always meet has a density that falls with the level.
  if (noise.is_known() ||
      likelihood.count().sum() <= static_cast<double>(movable_directions(problem, likelihood, peaks.front()))) {
    return std::nullopt;
  }
  Eigen::VectorXd medians(noise.count()), lowest(noise.count());
  for (Eigen::Index k = 0; k < noise.count(); ++k) {
    medians(k) = quantile_of(levels.col(k), 0.5);
    lowest(k) = quantile_of(levels.col(k), k_lowest);
  }
  const LinearNoise linear(problem, noise, likelihood, context, evaluations);
  try {
    std::vector<ReachingDraws> sets;
    for (const PosteriorPeak& peak : peaks) {
      const Linearised at = linear.best(peak, k_far_below * lowest);
      std::vector<LevelGrid> grids;
      for (Eigen::Index k = 0; k < noise.count(); ++k) grids.push_back(make_grid(linear, noise, at, medians, k));
      sets.emplace_back(linear, noise, at, std::move(grids));
    }
    return importance_evidence(sets, target, context);
  } catch (const SystemFailure&) {  // the model fails about these parameters: nothing can be told
    return std::nullopt;
  }
}

}  // namespace mottle::updating
