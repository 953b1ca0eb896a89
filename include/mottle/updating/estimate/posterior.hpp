// What a sampled posterior consists of beside its moments: chains of draws, how well they agree, evidence, modes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/chains/leave_one_out.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

namespace mottle::updating {

/// A region of high probability, apart from the others.
struct PosteriorMode {
  double probability = 0.0;
  double standard_error = 0.0;  ///< of it, from the spread of the chains
  Eigen::VectorXd mean = {};    ///< of the parameters there [parameter]
  Eigen::Index highest = 0;     ///< see SampledPosterior, of its draws
};

/// Draws of a posterior, all of equal weight: chain by chain, those of one chain one below the other. A chain is an
/// island of particles: neighbours have common ancestors, as consecutive draws of a Markov chain do.
struct SampledPosterior {
  Eigen::Index chains = 0;
  Eigen::Index draws = 0;          ///< of each chain
  std::vector<std::string> names;  ///< of the parameters, then of levels of the noise
  Eigen::MatrixXd values;          ///< [chain x draw, name]
  Eigen::VectorXd log_likelihood;  ///< [chain x draw]
  Eigen::Index highest = 0;        ///< the draw of the highest probability density in standard normal space
  Eigen::VectorXd r_hat;           ///< of each name, at last of the log-likelihood
  Eigen::VectorXd ess_bulk;        ///< effective sample sizes
  Eigen::VectorXd ess_tail;
  Evidence evidence;
  Eigen::VectorXd chain_log_evidence = {};         ///< of each chain alone
  std::vector<PosteriorMode> modes;                ///< the most probable first
  std::vector<std::vector<SamplingStage>> stages;  ///< of each chain
  std::int64_t failed_runs = 0;                    ///< of the model, whose likelihood is zero
  std::int64_t evaluations = 0;                    ///< by the sampler
  std::int64_t gradients = 0;                      ///< of the log-likelihood, in as many of the evaluations
  /// Outputs of the model at each draw; nan: it failed when it was run there again; empty: not known
  /// [chain x draw, output]
  Eigen::MatrixXd outputs = {};
  /// A further test of each draw, with noise and the model's error [chain x draw, output]
  Eigen::MatrixXd replicates = {};
  /// ln of the probability density of each specimen's test, where these are independent given a draw; else empty
  /// [chain x draw, specimen]
  Eigen::MatrixXd specimen_log_likelihood = {};
  std::optional<LeaveOneOut> leave_one_out = std::nullopt;  ///< by specimens
  std::optional<PredictiveAccuracy> waic = std::nullopt;    ///< by specimens
  std::string not_left_out = {};                            ///< why there is neither, as a sentence

  /// Trajectories along gradients, and how many of them diverged, in all stages.
  std::int64_t trajectories() const;
  std::int64_t divergences() const;

  /// The draws of one column, or of the log-likelihood [draw x chain].
  Eigen::MatrixXd chains_of(const Eigen::Ref<const Eigen::VectorXd>& column) const;
};

/// Whether regions of high probability are looked for, for which the log-likelihood must be that of the points alone.
enum class PosteriorModes { sought, not_sought };

/// Puts islands together.
///
/// @param names   of the columns of `values`
/// @param values  of every particle, island by island [particle x name]
SampledPosterior make_posterior(const std::vector<SampledIsland>& islands, std::vector<std::string> names,
                                Eigen::MatrixXd values, PosteriorModes modes = PosteriorModes::sought);

/// Keeps the log-likelihoods of the specimens, and how well the model predicts one that it has not seen.
///
/// @param log_likelihood  finite [chain x draw, specimen], >= 2 specimens
void add_specimens(Eigen::MatrixXd log_likelihood, SampledPosterior& posterior);

}  // namespace mottle::updating
