// A population of several batches with outliers.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// How batches are looked for.
struct MixtureOptions {
  using Noise = MaximumLikelihoodOptions::Noise;
  using Likelihood = MaximumLikelihoodOptions::Likelihood;
  enum class Scatter { own, common };

  int components = 0;  // automatic
  Scatter scatter = Scatter::own;
  double covariance_prior = 5.0;  // docs/theory: power at 10 specimens against bias where batches scatter differently
  double outlier_fraction = 0.01;
  double outlier_width = 3.0;
  Noise noise = Noise::automatic;
  Likelihood likelihood = Likelihood::restricted;
  int bootstrap_samples = 199;  // the level 5 % is one of their order statistics
  int starts = 8;
};

/// Name, range, default and meaning of each option.
const OptionTable<MixtureOptions>& mixture_option_table();

/// A specimen's parameters t_s (on the parameters' own scales) are sum_k w_k N(mu_k, Sigma_k), or an outlier's; its
/// test is z_s = f(t_s) + e_s, e_s ~ N(0, R). Each specimen's most probable t_s in its batch is found and f is
/// linearised there, which makes a mixture of linear random effects; and so on until it rests. Where one batch is found
/// and no outlier, the result is that of `maximum-likelihood`.
///
/// The theory: docs/theory/mixture.md. Source: [McLachlan2000]; [McLachlan1987]; [Lindstrom1990].
class MixtureUpdater final : public Updater {
 public:
  explicit MixtureUpdater(const MixtureOptions& options) : options_(options) {}

  /// Throws InvalidInput: fewer than 2 specimens, too few for the number of components, noise to be estimated from too
  /// few outputs.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return mixture_option_table().values(options_); }

 private:
  MixtureOptions options_;
};

}  // namespace mottle::updating
