// The first part of `abc`: clouds that come nearer to the tests, one after the other.
#pragma once

#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/methods/distance_fit.hpp"
#include "updating/methods/shared_offset.hpp"

namespace mottle::updating {

/// Where the search ended.
struct NearestPopulation {
  Eigen::VectorXd coordinates;
  std::shared_ptr<const CloudTransport> transport;  ///< of the last cloud
  std::shared_ptr<const SampleComparison> comparison;
  SharedOffset offset;            ///< taken off the tests before distances
  std::vector<double> distances;  ///< after each iteration; of Wasserstein's distance not the square
};

/// Evaluates the cloud of a population, finds the nearest population on it, and so on until no mean and no standard
/// deviation moves, or none is nearer than the last one; the history, status and message go into the result. Outputs
/// are made comparable anew in the first three iterations and alike from then on, so that distances can be compared.
///
/// @param result  its history holds the prior's cloud
NearestPopulation find_nearest_population(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                          const PopulationCoordinates& coordinates, SampleDistance distance,
                                          const RunContext& context, UpdatingResult& result);

/// Points of the clouds on which distances are taken.
inline constexpr Eigen::Index k_cloud_points = 400;

}  // namespace mottle::updating
