// Updating of one structure, or of the mean of many: regularised weighted least squares with analytic sensitivities.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// How the deterministic method is run.
struct DeterministicOptions {
  enum class Regularisation { none, tikhonov, bayesian };

  Regularisation regularisation = Regularisation::bayesian;
  double tikhonov_parameter = 1.0;
  int specimen = 0;                 // the mean of all: the usual reading of "the structure"
  double measurement_error = 0.01;  // one per cent, used only where no repeatability is given
};

/// Name, range, default and meaning of each option.
const OptionTable<DeterministicOptions>& deterministic_option_table();

/// Minimises over x within the bounds, by Gauss-Newton steps on the free parameters with step halving,
///
///   J(x) = (z - f(x))' W (z - f(x)) + (x - x0)' Q (x - x0),   W = diag(1 / sigma^2)
///
/// regularisation "none": Q = 0; "tikhonov": Q = lambda^2 diag(1 / s0^2); "bayesian": Q = S0^-1 (the estimator of
/// [Collins1974]). sigma is the repeatability of the outputs. The covariance that comes out is that of the estimate:
/// the posterior (G'WG + Q)^-1 for "bayesian", else the sampling covariance of x for noise of covariance W^-1.
/// It is not the scatter of specimens. Source: [Friswell1995], ch. 7 and 8.
///
/// J may have several minima: the lowest that is found is the estimate, those that fit no worse are
/// result.other_solutions.
class DeterministicUpdater final : public Updater {
 public:
  explicit DeterministicUpdater(const DeterministicOptions& options) : options_(options) {}

  /// Throws InvalidInput: more parameters than outputs without regularisation, parameters that the outputs cannot
  /// tell apart without regularisation, a specimen that is not there or has missing values.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return deterministic_option_table().values(options_); }

 private:
  DeterministicOptions options_;
};

/// dy/dx by the model's own derivatives, and by central differences where it has none.
///
/// @param scale        typical size of a change of each parameter; the differences take 1e-4 of it [parameter]
/// @param evaluations  raised by the model runs that were needed
/// @return             [output x parameter]
/// Throws SystemFailure where the model fails on both sides of a parameter.
Eigen::MatrixXd model_jacobian(const UpdatingProblem& problem, const Eigen::VectorXd& parameters,
                               const Eigen::VectorXd& scale, const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
