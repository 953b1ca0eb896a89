// Sequential Monte Carlo for a posterior whose likelihood is a cheap one, of few variables, times a dear correction of
// that one and of many more variables.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

namespace mottle::updating {

/// What the likelihood L of a SamplingTarget leaves out:
///
///   p(u, v) = N(u; 0, 1) L(u) prod_s N(v_s; 0, 1) exp(c_s(u, v_s)) / Z
struct Correction {
  Eigen::Index blocks = 0;      ///< of the auxiliary variables v, >= 1
  Eigen::Index block_size = 0;  ///< number of variables in each, >= 1
  /// c_s of each block; -infinity or nan: impossible.
  /// [point x dimension], [point x blocks * block_size] -> [point x block]
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& points, const Eigen::MatrixXd& auxiliaries)> log_ratio;
  /// Which blocks are possible, a cheap question; c_s is -infinity where they are not. Empty: all are.
  /// [point x dimension], [point x blocks * block_size] -> [point x block]
  using IsPossible = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;
  std::function<IsPossible(const Eigen::MatrixXd& points, const Eigen::MatrixXd& auxiliaries)> is_possible = {};
};

/// What one island found.
struct CorrectedIsland {
  SampledIsland island;         ///< its points are u, its log-likelihood ln L, its evidence the whole Z
  Eigen::MatrixXd auxiliaries;  ///< v [particle x blocks * block_size]
  Eigen::MatrixXd log_ratio;    ///< c_s [particle x block]
};

/// Samples p(u, v). The islands of sample_posterior() go from the prior to N(u) L(u) / Z_0, v is drawn from its prior
/// cut at what is possible, which has the probability P_s(u) of each block: draws until r = 5 are possible, N in all,
/// give the unbiased estimate (r - 1) / (N - 1) of P_s, by whose product the particles are weighted. Then p_b ~ N(u)
/// L(u) N(v) exp(b sum_s c_s) leads on, b from 0 to 1 in steps that leave 95 % of the particles effective: N may have
/// lighter tails than what it leads to, and long steps too heavy weights. A sweep of a stage has two
/// kinds of moves, each of which leaves p_b as it is:
///
/// - of every block by itself: v_s' = sqrt(1 - e^2) v_s + e w, w ~ N(0, 1), accepted by exp(b (c_s' - c_s)), or, as
///   often, v_s' = v_s + c w, accepted by N(v_s') / N(v_s) times that, which reaches heavier tails than N's;
/// - of u at given v: some Metropolis steps under N(u) L(u), which cost no correction, are one proposal, which is
///   accepted by exp(b sum_s (c_s(u') - c_s(u))): the proposal is reversible with respect to N(u) L(u).
///
/// Sweeps go on until no coordinate of u, no block and not sum c_s is correlated with the stage's start, and in the
/// last stage, whose particles are the draws, for three times as long again.
///
/// @throws as sample_posterior()
/// Source: [Liu2001], section 9.4.3, for the second kind; [Cotter2013] for the first; [Haldane1945] for the start.
std::vector<CorrectedIsland> sample_corrected(const SamplingTarget& target, const Correction& correction,
                                              const SamplingSettings& settings, const RunContext& context);

}  // namespace mottle::updating
