// The method of Mares, Mottershead and Friswell (2006): regression on a cloud, mean by Eq. 11, covariance by Eq. 12.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// What the paper leaves open or what its tables decode to; docs/theory/mares.md explains each.
struct MaresOptions {
  enum class Weighting { mahalanobis, euclidean };
  enum class Prior { recentred, fixed };
  enum class Covariance { fixed_prior, recursive };
  enum class Regression { linear, quadratic };

  Weighting weighting = Weighting::mahalanobis;
  Prior prior = Prior::recentred;                   // reproduces the published tables
  Covariance covariance = Covariance::fixed_prior;  // does not collapse when iterated
  Regression regression = Regression::linear;
  double model_error = 0.0;
};

/// Name, range, default and meaning of each option.
const OptionTable<MaresOptions>& mares_option_table();

/// Stochastic model updating after [Mares2006].
///
/// Each iteration draws a cloud from N(x_j, S_j), fits Y = 1 a' + X B + E, G = B', and moves
///
///   x_{j+1} = x_j + (G'WG + S^-1)^-1 (G'W (z - y_j) - S^-1 (x_j - c)),   within the bounds     (11)
///   S_{j+1} = P - P G' (S_M + G P G')^-1 G P,   S_M = V + model error                          (12)
///
/// prior "recentred": c = x_j, S = S0; "fixed": c = x0, S = P. covariance "fixed-prior": P = S0; "recursive": P = S_j.
/// weighting "mahalanobis": W = S_M^-1; "euclidean": W = p / trace(S_M) I.
class MaresUpdater final : public Updater {
 public:
  explicit MaresUpdater(const MaresOptions& options) : options_(options) {}

  /// Throws InvalidInput: fewer than two specimens, fewer outputs than parameters, a test variability S_M
  /// that is singular.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return mares_option_table().values(options_); }

 private:
  MaresOptions options_;
};

}  // namespace mottle::updating
