// The population whose cloud is nearest to the tests, on one evaluated cloud.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/methods/cloud_transport.hpp"
#include "updating/methods/sample_comparison.hpp"

namespace mottle::updating {

/// Value and gradient of a function at a point.
struct ValueAndGradient {
  double value = 0.0;
  Eigen::VectorXd gradient;
};

/// Minimum of a function between limits: BFGS steps of the variables that no limit holds, shortened until the value
/// falls. Ends when no variable moves by more than `tolerance`, or no step helps.
///
/// @param start         between the limits [variable]
/// @param lower, upper  [variable]
/// Source: [Nocedal2006], sections 6.1 and 16.7.
Eigen::VectorXd minimise_within(const std::function<ValueAndGradient(const Eigen::VectorXd&)>& function,
                                const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                const Eigen::VectorXd& upper, double tolerance, int iterations);

/// A cloud with noise as a function of a population's coordinates: base points and normal numbers for the noise stay
/// the same, so that distances are smooth.
class MovingCloud {
 public:
  MovingCloud(const PopulationCoordinates& coordinates, const CloudTransport& transport, Eigen::Index samples,
              std::uint64_t seed);

  /// [sample x output]
  Eigen::MatrixXd at(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const;
  /// Central differences, one [sample x output] a coordinate.
  std::vector<Eigen::MatrixXd> slopes(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const;

 private:
  const PopulationCoordinates& coordinates_;
  const CloudTransport& transport_;
  TransportBase base_;
  Eigen::MatrixXd noise_;  // standard normal [sample x output]
};

/// Coordinates of the population whose cloud is nearest to the tests, between limits: of
///
///   distance + 0.1 / n sum z^2 / 2,   z Fisher's of the partial correlations, n specimens
///
/// The second term, a tenth of a specimen's worth, keeps correlations off their limits where the tests leave them open.
///
/// @param tries_wider  from a second start with larger standard deviations, too
Eigen::VectorXd nearest_population(const PopulationCoordinates& coordinates, const MovingCloud& cloud,
                                   const SampleComparison& comparison, const Eigen::MatrixXd& tests,
                                   const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                   const Eigen::VectorXd& upper, bool tries_wider);

}  // namespace mottle::updating
