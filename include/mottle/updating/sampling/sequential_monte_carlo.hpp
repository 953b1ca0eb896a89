// Sequential Monte Carlo from a standard normal prior to a posterior, by independent islands of particles. It knows a
// batch log-likelihood and nothing else: no model, no tests.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/stats/chains/evidence_comparison.hpp"

namespace mottle::updating {

/// When moves follow the gradient of the likelihood.
enum class GradientMoves { automatic, always, never };

/// How a posterior is sampled.
struct SamplingSettings {
  int islands = 8;                  ///< >= 2, <= 256; from their spread comes the standard error of the evidence
  int particles = 1000;             ///< of each island, >= 20
  double effective_fraction = 0.5;  ///< of the particles, that the weights of a stage leave effective; in (0, 1)
  double decorrelation = 0.1;       ///< a half moves until no correlation of the other with its start is larger
  int max_moves = 200;              ///< of a stage, at most
  int max_stages = 500;
  std::int64_t max_evaluations = 0;  ///< likelihoods of all islands together, at least those of the start; 0: no limit
  /// Times as many moves as decorrelate are those of the last stage, whose particles are the draws and which is one of
  /// many.
  int last_stage_factor = 4;
  /// Automatic: in more than k_many_dimensions where the target has a gradient. Always and never: where it has one.
  GradientMoves gradients = GradientMoves::automatic;
};

/// Beyond it gradients save half of the evaluations and more; see benchmarks/BAYES.md.
inline constexpr Eigen::Index k_many_dimensions = 15;

/// ln L and its gradient at some points.
struct LikelihoodGradient {
  Eigen::VectorXd log_likelihood;  ///< [point]
  Eigen::MatrixXd gradient;        ///< d ln L / du [point x dimension]; nan where it is not known
};

/// What is sampled: p(u) = N(u; 0, 1) L(u) / Z where u is possible, Z relative to the prior cut at what is possible.
struct SamplingTarget {
  Eigen::Index dimension = 0;
  /// ln L of each point, all possible [point x dimension] -> [point]; -infinity or nan: L = 0, as where the model
  /// fails.
  std::function<Eigen::VectorXd(const Eigen::MatrixXd& points)> log_likelihood;
  /// Whether each point is possible; empty: all are [point x dimension] -> [point].
  std::function<std::vector<bool>(const Eigen::MatrixXd& points)> is_possible = {};
  /// Called before each batch with the particles of all islands [particle x dimension]; empty: nobody listens. Returns
  /// whether to go on; if not, sample_posterior() throws Stopped.
  std::function<bool(const Eigen::MatrixXd& particles)> before_batch = {};
  /// ln L as log_likelihood() has it, with its gradient; empty: there is none. A gradient that is not exact makes moves
  /// dearer, not wrong.
  std::function<LikelihoodGradient(const Eigen::MatrixXd& points)> with_gradient = {};
  /// What ln L is at most, of each point, for next to nothing: a proposal that would be rejected with it is not put to
  /// log_likelihood; empty: not known.
  std::function<Eigen::VectorXd(const Eigen::MatrixXd& points)> largest_log_likelihood = {};
};

/// Whether moves follow gradients.
bool follows_gradients(const SamplingTarget& target, const SamplingSettings& settings);

/// Up to so many dimensions the evidence and its error were found right against closed forms.
inline constexpr Eigen::Index k_dimensions_of_evidence = 30;

/// One step of an island from a power of the likelihood to the next.
struct SamplingStage {
  double exponent = 0.0;           ///< of the likelihood, at the stage's end
  double effective_samples = 0.0;  ///< that its weights left
  int moves = 0;                   ///< of every particle
  double acceptance = 0.0;         ///< fraction of the moves
  double correlation = 0.0;        ///< largest that was left with the stage's start
  bool is_decorrelated = true;     ///< it is no larger than is asked for, or than chance makes it
  std::int64_t trajectories = 0;   ///< of all particles, along gradients
  std::int64_t divergences = 0;    ///< of them
};

/// What one island found.
struct SampledIsland {
  Eigen::MatrixXd points;          ///< [particle x dimension], all of equal weight
  Eigen::VectorXd log_likelihood;  ///< [particle]
  double log_evidence = 0.0;
  std::vector<SamplingStage> stages;
  bool is_finished = true;  ///< false: stages or evaluations ran out
};

/// Where an evidence comes from.
enum class EvidenceSource { islands, importance_sampling };

/// Logarithm of the evidence.
struct Evidence : EstimatedEvidence {
  double lower = 0.0;  ///< ends of the 95 % interval, by Student's t
  double upper = 0.0;
  double spread = 0.0;  ///< standard deviation of the islands' ln evidences
  EvidenceSource source = EvidenceSource::islands;
};

/// Samples a posterior.
///
/// Each island starts from the prior and goes through the targets N(u; 0, 1) L^b, b from 0 to 1:
///
/// 1. b grows until the weights L^(b' - b) leave `effective_fraction` of the particles effective; the island's evidence
///    is multiplied by the mean weight;
/// 2. systematic resampling;
/// 3. Metropolis steps of three kinds, each of which leaves the target as it is: draws of a normal mixture g that is
///    fitted to particles, moves within the component that a particle belongs to (both accepted by p / g), and
///    steps along differences of two particles (accepted by p), for each half of the particles by those of the other.
///    They go on until no coordinate, no distance of one from its median and not the log-likelihood is correlated with
///    the stage's start, by normal scores of their ranks, and in the last stage for three times as long again.
///    In many dimensions three of four steps are Hamiltonian trajectories along gradients instead.
///
/// Where the next batch might exceed `max_evaluations`, islands end where they are, unfinished. The observer hears, as
/// soon as all islands have finished a stage and with each further one, how many evaluations are expected in all.
///
/// Islands share batches of evaluations and nothing else. Every random number is named by (seed, purpose, island,
/// stage, step, particle): the result is the same at any number of threads.
///
/// @throws InvalidInput  no particle of an island has a likelihood above zero; what is possible has no prior
///                       probability
/// @throws Stopped       on request
/// Source: [Ching2007], [DelMoral2006], [Zhou2016] for the effective samples, [TerBraak2006] for the differences,
/// [Neal2011] for the trajectories.
std::vector<SampledIsland> sample_posterior(const SamplingTarget& target, const SamplingSettings& settings,
                                            const RunContext& context);

/// The evidence of all islands together.
///
/// @param islands  >= 2
Evidence combine_evidence(const std::vector<SampledIsland>& islands);

/// Takes the estimate of an importance sample in its place, with the interval that it has; the spread stays.
void take_importance_evidence(const EstimatedEvidence& estimate, Evidence& evidence);

}  // namespace mottle::updating
