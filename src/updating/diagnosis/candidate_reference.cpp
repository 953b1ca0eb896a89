#include "updating/diagnosis/candidate_reference.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/core/random.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

constexpr int k_replications = 400;
constexpr double k_tail = 0.1;  // 40 excesses: their mean is known to 16 %

/// A covariance's square root.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const SymmetricEigen solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Where the draws come from: the set alone, its small-sample bias removed.
struct NullModel {
  const std::vector<RandomEffectsUnit>& units;
  RandomEffectsFit fit;
  Eigen::MatrixXd root;
  std::uint64_t seed = 1;

  /// Responses of one draw, unit by unit.
  std::vector<Eigen::VectorXd> draw(std::int64_t replication) const {
    const StreamKey key{
        .seed = seed, .purpose = StreamPurpose::bootstrap, .iteration = static_cast<std::uint32_t>(replication)};
    std::vector<Eigen::VectorXd> responses;
    for (std::size_t s = 0; s < units.size(); ++s) {
      RandomStream stream(key, static_cast<std::uint32_t>(s));
      const auto normal = [&](double) { return standard_normal_quantile(stream.uniform()); };
      const RandomEffectsUnit& unit = units[s];
      const Eigen::VectorXd effect = fit.mean + root * Eigen::VectorXd::Zero(root.cols()).unaryExpr(normal).eval();
      Eigen::VectorXd noise = noise_of(unit, fit.noise_factors);
      for (double& value : noise) value = std::sqrt(value) * standard_normal_quantile(stream.uniform());
      responses.push_back(unit.design * effect + noise);
    }
    return responses;
  }
};

double log_likelihood(LinearProblem problem, const std::vector<Eigen::VectorXd>& responses) {
  for (std::size_t s = 0; s < responses.size(); ++s) problem.units[s].response = responses[s];
  return fit_random_effects(problem.units, problem.start, problem.settings).log_likelihood;
}

/// Probability of a ratio of at least `observed`, from draws of it.
double upper_tail(std::vector<double> draws, double observed) {
  std::sort(draws.begin(), draws.end());
  const auto count = static_cast<double>(draws.size());
  const auto first = draws.size() - static_cast<std::size_t>(k_tail * count);
  const double border = draws[first - 1];
  if (observed <= border) {
    const auto beyond = draws.end() - std::lower_bound(draws.begin(), draws.end(), observed);
    return (1.0 + static_cast<double>(beyond)) / (1.0 + count);
  }
  const double excess = std::accumulate(draws.begin() + static_cast<std::ptrdiff_t>(first), draws.end(), 0.0) /
                            static_cast<double>(draws.size() - first) -
                        border;
  return k_tail * std::exp(-(observed - border) / std::max(excess, 1e-12));
}

}  // namespace

void refer_to_replications(const CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                           const std::vector<Eigen::MatrixXd>& derivatives, const std::vector<CandidateTry>& tries) {
  const LinearProblem alone = fits.linear_problem(base, set);
  RandomEffectsSettings restricted = alone.settings;
  restricted.is_restricted = true;
  NullModel null{alone.units, fit_random_effects(alone.units, alone.start, restricted), {}, fits.context().seed};
  null.root = root_of(null.fit.covariance);
  std::vector<LinearProblem> problems;
  for (const CandidateTry& each : tries) {
    problems.push_back(fits.linear_problem(base, set, each.candidate, each.fit->is_random, derivatives));
  }
  Eigen::MatrixXd ratios(k_replications, static_cast<Eigen::Index>(tries.size()));
  parallel_for(k_replications, 8, fits.context().threads, [&](std::int64_t begin, std::int64_t end) {
    fits.context().throw_if_stopped();
    for (std::int64_t b = begin; b < end; ++b) {
      const std::vector<Eigen::VectorXd> responses = null.draw(b);
      const double less = log_likelihood(alone, responses);
      for (std::size_t k = 0; k < problems.size(); ++k) {
        const double more = log_likelihood(problems[k], responses);
        ratios(b, static_cast<Eigen::Index>(k)) = std::max(2.0 * (more - less), 0.0);
      }
    }
  });
  for (std::size_t k = 0; k < tries.size(); ++k) {
    const auto column = ratios.col(static_cast<Eigen::Index>(k));
    if (!column.allFinite()) continue;
    const double p =
        upper_tail({column.begin(), column.end()}, std::max(2.0 * tries[k].fit->log_likelihood_increase, 0.0));
    tries[k].fit->p_value = std::max(tries[k].fit->p_value, p);
  }
}

}  // namespace mottle::updating
