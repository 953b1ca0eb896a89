// Per-specimen inversion: each specimen's parameters are solved for alone; the population is their sample.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// How per-specimen inversion is run.
struct InversionOptions {
  enum class Start { tests_mean, prior_mean };

  Start start = Start::tests_mean;  // one start near all specimens keeps them on one branch of the inverse
};

/// Name, range, default and meaning of each option.
const OptionTable<InversionOptions>& inversion_option_table();

/// Solves every specimen s for its own parameters, on their scales and within the bounds,
///
///   t_s = argmin sum_k ((z_sk - f_k(t)) / sigma_k)^2   over the entries that were measured,
///
/// and takes mean and unbiased covariance of the t_s, within the problem's covariance groups. sigma is the
/// repeatability of an output where it is given, else the tests' deviation. A specimen with fewer measured outputs than
/// parameters gets the solution nearest to the prior mean in prior deviations.
///
/// Exact where f is one-to-one and there is no noise: then t_s is the specimen. Noise e adds the covariance of T e,
/// T = (G'WG)^-1 G'W, to that of the specimens: the deviations come out too large. Intervals are those of a normal
/// sample. Source: [Fang2012], [Rui2013].
class InversionUpdater final : public Updater {
 public:
  explicit InversionUpdater(const InversionOptions& options) : options_(options) {}

  /// Throws InvalidInput: fewer than two specimens; SystemFailure: the model fails at the start, or more specimens than
  /// problem.cloud.most_failed find no solution.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return inversion_option_table().values(options_); }

 private:
  InversionOptions options_;
};

}  // namespace mottle::updating
