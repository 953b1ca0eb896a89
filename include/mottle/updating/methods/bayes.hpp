// SampledPosterior of the parameters of one structure, or of parameters that all specimens have in common, with its
// evidence.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

namespace mottle::updating {

/// How the posterior is sampled and what is known of the noise.
struct BayesOptions {
  enum class Noise { automatic, given, estimated };
  enum class NoisePrior { half_t, inverse_gamma };

  Noise noise = Noise::automatic;
  NoisePrior noise_prior = NoisePrior::half_t;
  double noise_scale = 0.01;              // one per cent: what a good modal test has of a frequency
  double noise_degrees_of_freedom = 4.0;  // finite variance, but a level ten times the scale is not excluded
  int islands = 8;                        // fewer give no standard error to rely on
  int particles = 1000;
  double effective_fraction = 0.0;  // automatic
  double decorrelation = 0.1;
  int max_moves = 1000;     // 200 ended stages of 5 % of seeds before they had decorrelated where a mode vanishes
  int max_evaluations = 0;  // no limit
  GradientMoves gradients = GradientMoves::automatic;
};

/// Name, range, default and meaning of each option.
const OptionTable<BayesOptions>& bayes_option_table();

/// p(x | tests) ~ p(x) prod_s N(z_s; f(x) + d, R), d ~ N(0, D) shared by all specimens and integrated out, by
/// sequential Monte Carlo in standard normal space. x is one vector: the parameters of one structure, or what all
/// specimens have in common. The prior is cut at bounds and physical limits. R is known, or its levels are sampled with
/// x. A model run that fails has likelihood zero.
///
/// The theory: docs/theory/bayes.md. Source: [Beck1998]; [Ching2007].
class BayesUpdater final : public Updater {
 public:
  explicit BayesUpdater(const BayesOptions& options) : options_(options) {}

  /// Throws InvalidInput: noise is neither known nor estimated; the likelihood is zero wherever the prior was drawn.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return bayes_option_table().values(options_); }

 private:
  BayesOptions options_;
};

}  // namespace mottle::updating
