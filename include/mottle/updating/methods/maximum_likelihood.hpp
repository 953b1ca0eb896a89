// The population of the specimens by (restricted) maximum likelihood: random effects in a non-linear model.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// How the maximum-likelihood method is run.
struct MaximumLikelihoodOptions {
  enum class Likelihood { restricted, plain };
  enum class Noise { automatic, given, estimated };
  enum class Intervals { analytic, bootstrap, none };

  Likelihood likelihood = Likelihood::restricted;  // unbiased deviations from few specimens
  Noise noise = Noise::automatic;
  Intervals intervals = Intervals::analytic;
  int bootstrap_samples = 400;   // tails of 2.5 % from 10 samples each
  double rank_tolerance = 1e-3;  // weaker combinations move less than a thousandth of the strongest: noise drowns them
};

/// Name, range, default and meaning of each option.
const OptionTable<MaximumLikelihoodOptions>& maximum_likelihood_option_table();

/// A specimen's parameters t_s (on the parameters' own scales) are N(mu, Sigma), its test z_s = f(t_s) + e_s with
/// e_s ~ N(0, R). Every specimen's most probable t_s is found; f is linearised there, which makes a linear
/// random-effects problem; its restricted-likelihood estimate gives mu, Sigma and, where asked, R; and so on until they
/// rest. With R = 0 and as many outputs as parameters the estimate is mean and unbiased covariance of the inverted
/// tests. Combinations of parameters that the outputs do not see stay at the prior's mean and without scatter.
///
/// The theory: docs/theory/maximum-likelihood.md. Source: [Lindstrom1990]; [Laird1982].
class MaximumLikelihoodUpdater final : public Updater {
 public:
  explicit MaximumLikelihoodUpdater(const MaximumLikelihoodOptions& options) : options_(options) {}

  /// Throws InvalidInput: fewer than 2 specimens, noise to be estimated from too few outputs.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return maximum_likelihood_option_table().values(options_); }

 private:
  MaximumLikelihoodOptions options_;
};

}  // namespace mottle::updating
