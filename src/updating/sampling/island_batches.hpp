// Islands that share batches of evaluations and nothing else.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/sampling/island.hpp"

namespace mottle::updating {

using Islands = std::vector<std::unique_ptr<Island>>;

/// Rows of all matrices, one below the other.
Eigen::MatrixXd stacked(const std::vector<const Eigen::MatrixXd*>& parts, Eigen::Index columns);

/// One turn of each of these islands: what they ask for, evaluated as one batch. Returns the number of evaluations.
std::int64_t advance(const SamplingTarget& target, const std::vector<Island*>& working, int threads);

/// Whether the observer hears how many evaluations are expected: where each is a model run.
enum class Forecast { told, not_told };

/// Islands that have gone from the prior to the posterior. Target and settings must outlive them. Errors:
/// sample_posterior().
Islands run_islands(const SamplingTarget& target, const SamplingSettings& settings, const RunContext& context,
                    Forecast forecast);

}  // namespace mottle::updating
