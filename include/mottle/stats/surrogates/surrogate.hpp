// Surrogates: functions fitted to the runs of an expensive model (response surface, Gaussian process, polynomial
// chaos).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

enum class SurrogateKind {
  quadratic,  ///< all terms up to the second degree, by least squares
  kriging,    ///< Gaussian process with a Matern 5/2 covariance and a constant or linear trend
  chaos,      ///< sparse Legendre expansion, terms chosen by least-angle regression
};

/// Names of SurrogateKind, in its order.
const std::vector<std::string>& surrogate_kinds();

/// Outputs as functions of inputs, with an error that was measured on runs left out of the fit. Value type.
class Surrogate {
 public:
  /// Fits each output to the runs, and to each nine tenths of them for the error (covariance lengths of a Gaussian
  /// process are those of all runs throughout). Inputs and outputs are scaled to their range first.
  ///
  /// @param inputs   [run x input], any units
  /// @param outputs  [run x output], none nan
  /// @throws InvalidInput   fewer runs than min_runs()
  /// @throws SystemFailure  the fit breaks down (runs that coincide with different outputs)
  /// Source: [Rasmussen2006] Gaussian processes; [Blatman2011] sparse expansions; computed by OpenTURNS.
  Surrogate(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& inputs,
            const Eigen::Ref<const Eigen::MatrixXd>& outputs);

  /// Smallest number of runs that allows the fits without a tenth of them.
  static Eigen::Index min_runs(SurrogateKind kind, Eigen::Index inputs);

  /// Outputs at `inputs` [point x input]: [point x output].
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& inputs) const;

  /// Output of each run minus the prediction of the fit without it [run x output].
  const Eigen::MatrixXd& left_out_residuals() const { return residuals_; }

  class Fit;

 private:
  Eigen::MatrixXd scaled(const Eigen::Ref<const Eigen::MatrixXd>& inputs) const;

  Eigen::RowVectorXd input_centre_, input_scale_, output_centre_, output_scale_;
  std::shared_ptr<const Fit> fit_;
  Eigen::MatrixXd residuals_;
};

}  // namespace mottle::stats
