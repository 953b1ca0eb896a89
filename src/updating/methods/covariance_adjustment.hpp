// Covariance adjustment of Govers and Link (2010): the model's cloud is given the mean and covariance of the tests.
#pragma once

#include "mottle/layers.hpp"
#include "updating/methods/moment_iteration.hpp"

namespace mottle::updating {

/// How covariance adjustment is run.
struct CovarianceAdjustmentOptions {
  enum class CloudKind { monte_carlo, first_order };

  CloudKind cloud = CloudKind::monte_carlo;
  MomentWeighting weighting = MomentWeighting::variance;
};

/// Name, range, default and meaning of each option.
const OptionTable<CovarianceAdjustmentOptions>& covariance_adjustment_option_table();

/// With the sensitivities G at the mean and y, C the mean and covariance of the model's cloud, iterates on the
/// parameters' scales
///
///   mu <- mu + T (z - y),   S <- S + T (V - R - C) T',   T = (G'WG)^-1 G'W
///
/// to the fixed point y = z, C + R = V (their projections by T where there are more outputs than parameters); S is kept
/// positive semi-definite. The cloud is of problem.cloud.samples points that are the same at every iteration up to
/// shift and shear, with mean and covariance exactly those of the parameters; "first-order": y = f(mu), C = G S G'.
/// Source: [Govers2010].
class CovarianceAdjustmentUpdater final : public Updater {
 public:
  explicit CovarianceAdjustmentUpdater(const CovarianceAdjustmentOptions& options) : options_(options) {}

  /// Throws as iterate_moments() and evaluate_by_rule(); InvalidInput: fewer samples than parameters.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return covariance_adjustment_option_table().values(options_); }

 private:
  CovarianceAdjustmentOptions options_;
};

}  // namespace mottle::updating
