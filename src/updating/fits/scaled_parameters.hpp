// The parameters on the scales on which their population is normal: prior, bounds, derivatives there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Prior mean and covariance on the parameters' scales: those of the prior itself for the identity, to first order
/// through the mean else.
struct PriorOnScales {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};
PriorOnScales prior_on_scales(const ParameterSpace& space);

/// Everything that a method which works with t = g(x) needs of a ParameterSpace.
class ScaledParameters {
 public:
  explicit ScaledParameters(const ParameterSpace& space);

  Eigen::Index count() const { return start_.size(); }
  const std::vector<ParameterTransform>& scales() const { return scales_; }
  /// t of the prior mean.
  const Eigen::VectorXd& start() const { return start_; }
  /// Prior deviations of t to first order: s_x / (dx/dt).
  const Eigen::VectorXd& standard_deviation() const { return standard_deviation_; }
  /// Prior covariance of t to first order.
  const Eigen::MatrixXd& covariance() const { return covariance_; }

  /// x of t, row by row [point x parameter].
  Eigen::MatrixXd to_variables(const Eigen::Ref<const Eigen::MatrixXd>& points) const;
  /// dx/dt of each parameter at one point.
  Eigen::VectorXd slopes(const Eigen::Ref<const Eigen::VectorXd>& point) const;
  /// The nearest point whose x lie within bounds and physical limits.
  Eigen::VectorXd clamp(const Eigen::Ref<const Eigen::VectorXd>& point) const;
  /// -1 where t lies on the lower end of what clamp() allows, +1 on the upper, else 0.
  Eigen::VectorXi active_bounds(const Eigen::Ref<const Eigen::VectorXd>& point) const;

 private:
  std::vector<ParameterTransform> scales_;
  Eigen::VectorXd start_;
  Eigen::VectorXd standard_deviation_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
};

/// Outputs of points t [specimen x parameter] on the parameters' scales; nan where a run fails or
/// where x is physically impossible, which is not put to the model.
Eigen::MatrixXd outputs_on_scales(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& points,
                                  const RunContext& context, std::int64_t& evaluations);

/// dy/dx by the model's own derivatives; nan where it has none [output x parameter].
Eigen::MatrixXd own_derivatives(const UpdatingProblem& problem, const Eigen::VectorXd& variables);

/// dy/dt at each of several points: the model's own derivatives (at more than one point only where they are cheap), and
/// central differences (steps of the model's in prior deviations, all points in one batch) for what it does not give. A
/// difference whose runs fail on one side is taken
/// from the other; where both fail, the entries stay nan.
///
/// @param points       [point x parameter]
/// @param outputs      f there [point x output]
/// @param evaluations  raised by the model runs that were needed
/// @return             one [output x parameter] a point
std::vector<Eigen::MatrixXd> scaled_jacobians(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                              const Eigen::Ref<const Eigen::MatrixXd>& points,
                                              const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                              const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
