#include "updating/diagnosis/candidate_reference.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/core/random.hpp"
#include "mottle/core/work_counter.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/diagnosis/ratio_draws.hpp"

namespace mottle::updating {
namespace {

constexpr int k_replications = 400;
constexpr int k_block = 100;  // draws after which decided tries are left out
// Expectation-maximisation is slow where a variance is zero: what n specimens have left of it after k steps is worth
// n / (2 k) of a log-likelihood at most, and only in draws without an effect, which are not those of the tail.
constexpr int k_iterations = 300;
constexpr double k_tolerance = 1e-6;

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

/// Fits of draws start near what they were drawn from, kept off the border of its covariance.
void start_near(const NullModel& null, const Eigen::MatrixXd& start, LinearProblem& problem) {
  constexpr double k_fresh = 0.01;
  problem.start.topLeftCorner(start.rows(), start.cols()) = (1.0 - k_fresh) * null.fit.covariance + k_fresh * start;
  problem.settings.iterations = k_iterations;
  problem.settings.tolerance = k_tolerance;
}

double log_likelihood(LinearProblem problem, const std::vector<Eigen::VectorXd>& responses) {
  for (std::size_t s = 0; s < responses.size(); ++s) problem.units[s].response = responses[s];
  return fit_random_effects(problem.units, problem.start, problem.settings).log_likelihood;
}

/// A try whose ratio is referred to draws, as long as these leave a doubt.
struct Referred {
  CandidateTry subject;
  LinearProblem problem;
  std::vector<double> ratios = {};
  bool is_decided = false;

  double observed() const { return std::max(2.0 * subject.fit->log_likelihood_increase, 0.0); }
};

/// Ratios of the draws `first` to `first + count` of all tries that are not decided.
void add_ratios(const NullModel& null, const LinearProblem& alone, int first, int count, const RunContext& context,
                std::vector<Referred>& tries) {
  for (Referred& each : tries) {
    if (!each.is_decided) each.ratios.resize(static_cast<std::size_t>(first + count));
  }
  WorkCounter counter(context, "draws", count);
  parallel_for(count, 4, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = first + begin; b < first + end; ++b) {
      context.throw_if_stopped();
      const std::vector<Eigen::VectorXd> responses = null.draw(b);
      const double less = log_likelihood(alone, responses);
      for (Referred& each : tries) {
        if (each.is_decided) continue;
        const double more = log_likelihood(each.problem, responses);
        each.ratios[static_cast<std::size_t>(b)] = std::max(2.0 * (more - less), 0.0);
      }
      counter.add();
    }
  });
}

bool are_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace

void refer_to_replications(const CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                           std::size_t candidates, const std::vector<CandidateTry>& tries) {
  LinearProblem alone = fits.linear_problem(base, set);
  RandomEffectsSettings restricted = alone.settings;
  restricted.is_restricted = true;
  NullModel null{alone.units, fit_random_effects(alone.units, alone.start, restricted), {}, fits.context().seed};
  null.root = root_of(null.fit.covariance);
  std::vector<Referred> referred;
  for (const CandidateTry& each : tries) {
    referred.push_back({each, fits.linear_problem(base, set, each.candidate, each.fit->is_random, each.effects)});
    start_near(null, alone.start, referred.back().problem);
  }
  start_near(null, Eigen::MatrixXd(alone.start), alone);
  const double level = fits.problem().level;
  const double least = level / (2.0 * static_cast<double>(candidates));  // of Holm's levels
  fits.context().phase({.name = "replications without a candidate"});
  for (int drawn = 0; drawn < k_replications; drawn += k_block) {
    add_ratios(null, alone, drawn, k_block, fits.context(), referred);
    for (Referred& each : referred) {
      if (each.is_decided) continue;
      each.is_decided = !are_finite(each.ratios) || RatioDraws(each.ratios).decide(each.observed(), least, level);
    }
    if (std::all_of(referred.begin(), referred.end(), [](const Referred& each) { return each.is_decided; })) break;
  }
  for (const Referred& each : referred) {
    if (!are_finite(each.ratios)) continue;
    double& p = each.subject.fit->p_value;
    p = std::max(p, RatioDraws(each.ratios).upper_tail(each.observed()));
  }
}

}  // namespace mottle::updating
