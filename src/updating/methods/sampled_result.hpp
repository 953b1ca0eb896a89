// What methods that sample a posterior have in common: options of noise and sampler, and how a run ended.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "mottle/core/options.hpp"
#include "mottle/layers.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "updating/methods/common_likelihood.hpp"

namespace mottle::updating {

/// Puts the options of BayesOptions into a table of options that have them.
template <typename Options>
OptionTable<Options>& add_sampling_options(OptionTable<Options>& table) {
  return table
      .template choice<BayesOptions::Noise>(
          "noise", &BayesOptions::noise,
          {{"automatic", BayesOptions::Noise::automatic},
           {"given", BayesOptions::Noise::given},
           {"estimated", BayesOptions::Noise::estimated}},
          "Measurement noise: as given by [test] repeatability, or of unknown level, one for "
          "each kind of output, which is sampled with the parameters. Automatic: of unknown "
          "level for the outputs without repeatability.")
      .template choice<BayesOptions::NoisePrior>(
          "noise_prior", &BayesOptions::noise_prior,
          {{"half-t", BayesOptions::NoisePrior::half_t}, {"inverse-gamma", BayesOptions::NoisePrior::inverse_gamma}},
          "Prior of a level: its standard deviation half-t, or its variance inverse gamma "
          "(scaled inverse chi-squared).")
      .number("noise_scale", &BayesOptions::noise_scale, {.lower = 0.0, .excludes_lower = true},
              "fraction of the value",
              "Scale of that prior, as a fraction of the root mean square of the tested values.")
      .number("noise_degrees_of_freedom", &BayesOptions::noise_degrees_of_freedom, {.lower = 1.0, .upper = 1e6}, "-",
              "Degrees of freedom of that prior: few leave a level of many times its scale possible.")
      .integer("islands", &BayesOptions::islands, {.lower = 8.0, .upper = 256.0}, "-",
               "Number of independent islands of particles; their spread gives the standard error of the evidence.")
      .integer("particles", &BayesOptions::particles, {.lower = 100.0, .upper = 100000.0}, "-",
               "Number of particles of each island, which are the draws of its chain; of all islands at most "
               "2,000,000.")
      .number_or("effective_fraction", &BayesOptions::effective_fraction, {.lower = 0.1, .upper = 0.99}, "automatic",
                 0.0,
                 "Fraction of the particles that the weights of a stage leave effective; a larger one makes more and "
                 "shorter stages. Automatic: 0.8 where `bayes` samples a level of the noise, else 0.5.")
      .number("decorrelation", &BayesOptions::decorrelation, {.lower = 0.02, .upper = 0.9}, "-",
              "Moves of a stage go on until no parameter, no square of one and not the log-likelihood is correlated "
              "more with its value at the stage's start, or no more than chance has it among so many particles.")
      .integer("max_moves", &BayesOptions::max_moves, {.lower = 1.0, .upper = 60000.0}, "-",
               "Largest number of moves of a particle in a stage.");
}

/// @throws InvalidInput  more than 2,000,000 draws of all islands
void require_draws(const std::string& method, const BayesOptions& options);

/// @param effective_fraction  where the options leave it automatic
SamplingSettings settings_of(const BayesOptions& options,
                             double effective_fraction = SamplingSettings{}.effective_fraction);

/// Power of the likelihood under which all draws at least are: 1 where the posterior was reached.
double smallest_exponent(const SampledPosterior& posterior);

/// Status, message and warnings of a result: whether the islands are one sample.
///
/// @param method       whose options a message names
/// @param is_finished  no island ran out of stages or evaluations
void conclude_sampling(const SampledPosterior& posterior, const std::string& method, const BayesOptions& options,
                       bool is_finished, UpdatingResult& result);

/// Says how many runs of the sampler failed.
/// @param whose  likelihood is zero there
void note_failed_runs(const SampledPosterior& posterior, const std::string& whose, UpdatingResult& result);

/// The result of a run that was stopped, which has the prior's moments.
UpdatingResult stopped_result(UpdatingResult result, const UpdatingProblem& problem, const std::string& when);

/// The smallest effective sample size of a parameter; nothing where none is known, as of a prior without width.
std::optional<double> least_effective(const SampledPosterior& posterior);

/// Variances of the noise: as given, or means over draws of its levels [draw x level] -> [output].
Eigen::VectorXd mean_noise(const NoiseLevels& noise, const Eigen::Ref<const Eigen::MatrixXd>& levels);

}  // namespace mottle::updating
