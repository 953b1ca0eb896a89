// Where the search for a mixture starts.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/stats/population/normal_mixture.hpp"

namespace mottle::stats {

/// All units, and the half of them nearest to the median: starts of one component [unit x 1].
std::vector<Eigen::MatrixXd> whole_starts(const Eigen::MatrixXd& points);

/// Each component of a fit split in two at a value of a direction, the best `count` of all splits: those with the
/// largest sum of squares between the parts over that within them [unit x components].
std::vector<Eigen::MatrixXd> split_starts(const Eigen::MatrixXd& points, const MixtureFit& fewer, int count,
                                          const StreamKey& key);

/// Parts nearest to drawn units, as k-means makes them [unit x components].
std::vector<Eigen::MatrixXd> random_starts(const Eigen::MatrixXd& points, int components, int count,
                                           const StreamKey& key);

}  // namespace mottle::stats
