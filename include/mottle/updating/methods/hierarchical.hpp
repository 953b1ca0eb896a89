// Posterior of a population of specimens: its mean and covariance, every specimen, and a new one, with the evidence.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// What is known of the scatter before the tests, beside what BayesOptions says of noise and sampler.
struct HierarchicalOptions : BayesOptions {
  enum class CovariancePrior { lkj, inverse_wishart };

  HierarchicalOptions() {
    particles = 500;       // each costs several model runs for each specimen
    decorrelation = 0.25;  // many moves of some ten numbers; islands still agree
  }

  CovariancePrior covariance_prior = CovariancePrior::lkj;
  double scatter_scale = 1.0;               // specimens may scatter by as much as is not known of their mean
  double scatter_degrees_of_freedom = 4.0;  // finite variance, but ten times the scale is not excluded
  double correlation_shape = 2.0;           // mildly against correlations of 1, which few specimens cannot exclude
};

/// Name, range, default and meaning of each option.
const OptionTable<HierarchicalOptions>& hierarchical_option_table();

/// On the parameters' scales specimens are t_s ~ N(mu, Sigma), Sigma = S R S, and their tests z_s = f(t_s) + d + e_s.
/// mu has the study's prior of the parameters, S is half-t, R is LKJ (or Sigma inverse Wishart), noise is known or its
/// levels have a prior, the model's error d ~ N(0, D) is shared. All are sampled jointly. Parameters of different
/// covariance groups are not correlated. A specimen whose model run fails has likelihood zero.
///
/// The theory: docs/theory/hierarchical.md. Source: [Gelman2006]; [Lewandowski2009]; [Liu2001].
class HierarchicalUpdater final : public Updater {
 public:
  explicit HierarchicalUpdater(const HierarchicalOptions& options) : options_(options) {}

  /// Throws InvalidInput: fewer than 2 specimens, one without any value, noise neither known nor estimated.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return hierarchical_option_table().values(options_); }

 private:
  HierarchicalOptions options_;
};

}  // namespace mottle::updating
