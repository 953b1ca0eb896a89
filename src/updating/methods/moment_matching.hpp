// Moment matching: the population whose outputs have the tests' mean and covariance, not linearised.
#pragma once

#include "mottle/layers.hpp"
#include "updating/methods/moment_iteration.hpp"

namespace mottle::updating {

/// How moment matching is run.
struct MomentMatchingOptions {
  enum class Rule { automatic, gauss_hermite, fifth_degree, cloud };

  Rule rule = Rule::automatic;
  int points = 5;  // the outermost 2.9 deviations from the mean: seldom impossible; exact to degree 9
  MomentWeighting weighting = MomentWeighting::variance;
};

/// Name, range, default and meaning of each option.
const OptionTable<MomentMatchingOptions>& moment_matching_option_table();

/// Finds mean mu and covariance S of the parameters, normal on their scales, with
///
///   E[f(x)] = z,   Cov[f(x)] = V - R
///
/// (their projections by T = (G'WG)^-1 G'W where there are more outputs than parameters), by quasi-Newton steps that
/// take G at the mean for the derivative of both:
///
///   mu <- mu + T (z - E[f]),   S <- S + T (V - R - Cov[f]) T'
///
/// The expectations are integrals over the normal distribution by a rule of points. "automatic": Gauss-Hermite up to
/// 3 parameters, the symmetric rule of degree 5 up to 8, a standardised cloud of problem.cloud.samples points beyond.
class MomentMatchingUpdater final : public Updater {
 public:
  explicit MomentMatchingUpdater(const MomentMatchingOptions& options) : options_(options) {}

  /// Throws as iterate_moments() and evaluate_by_rule(); InvalidInput: too many points for Gauss-Hermite.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return moment_matching_option_table().values(options_); }

 private:
  MomentMatchingOptions options_;
};

}  // namespace mottle::updating
