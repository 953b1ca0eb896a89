// The outputs of any population near that of an evaluated cloud, without further runs of the model.
#pragma once

#include <Eigen/Core>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/stats/surrogates/regression.hpp"
#include "updating/population/population_coordinates.hpp"

namespace mottle::updating {

/// Points of a standard normal population and what the surface misses of the outputs at each.
struct TransportBase {
  Eigen::MatrixXd points;    ///< u [point x parameter]
  Eigen::MatrixXd residual;  ///< y - surface [point x output]
};

/// Outputs of an evaluated cloud, carried to another population: with u the cloud's points, standardised,
///
///   y(u; mu, L) = surface(v) + (y_cloud - surface(u)),   v = L_c^-1 (mu + L u - mu_c)
///
/// surface: quadratic where there are samples for it, else linear; a straight line beyond 3 + sqrt(q) standard
/// deviations. Of the cloud's own population (mu_c, L_c) the outputs are those that were evaluated.
class CloudTransport {
 public:
  /// @param cloud  its failed runs are left out
  /// @throws InvalidInput  too few samples for a linear surface
  CloudTransport(const Cloud& cloud, const ScaledParameters& parameters);

  /// Every point of the cloud.
  const TransportBase& base() const { return base_; }
  /// The first points of the cloud, with mean 0 and covariance I again.
  TransportBase thinned(Eigen::Index count) const;

  /// Outputs of the base's points in another population, without noise [point x output].
  Eigen::MatrixXd outputs(const SampledPopulation& population, const TransportBase& base) const;
  /// Slope of the surface at a mean, dy/dt [output x parameter].
  Eigen::MatrixXd sensitivity(const Eigen::Ref<const Eigen::VectorXd>& mean) const;
  /// Fraction of each output's variance in the cloud that is not linear in the parameters [output].
  const Eigen::VectorXd& curvature() const { return curvature_; }

 private:
  Eigen::MatrixXd surface(const Eigen::Ref<const Eigen::MatrixXd>& points) const;

  Eigen::VectorXd mean_;    // mu_c
  Eigen::MatrixXd factor_;  // L_c
  QuadraticRegression surface_;
  bool is_quadratic_ = false;
  double reach_ = 0.0;
  TransportBase base_;
  Eigen::VectorXd curvature_;
};

}  // namespace mottle::updating
