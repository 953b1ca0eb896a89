// The perturbation method of Khodaparast, Mottershead and Friswell (2008): mean and covariance to first order.
#pragma once

#include "mottle/layers.hpp"
#include "updating/methods/moment_iteration.hpp"

namespace mottle::updating {

/// How the perturbation method is run.
struct PerturbationOptions {
  MomentWeighting weighting = MomentWeighting::variance;
};

/// Name, range, default and meaning of each option.
const OptionTable<PerturbationOptions>& perturbation_option_table();

/// With the sensitivities G at the mean, iterates on the parameters' scales
///
///   mu <- mu + T (z - f(mu)),   S <- (I - TG) S (I - TG)' + T (V - R) T',   T = (G'WG)^-1 G'W
///
/// to f(mu) = z (its weighted least squares where there are more outputs than parameters). Where G has no full rank T
/// is of least change in prior deviations, and what the outputs do not see keeps its prior. With covariance groups S
/// is the best fit of that pattern to V - R.
///
/// It is first order: the mean output of a wide population is not the output at its mean, and what that makes of mean
/// and deviation stays in them; moment matching has not this error. Source: [Khodaparast2008].
class PerturbationUpdater final : public Updater {
 public:
  explicit PerturbationUpdater(const PerturbationOptions& options) : options_(options) {}

  /// Throws as iterate_moments().
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return perturbation_option_table().values(options_); }

 private:
  PerturbationOptions options_;
};

}  // namespace mottle::updating
