// Regions of high probability among draws whose density is known.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// Which mode each draw belongs to, from 0 on; 0 is the most probable.
///
/// Up to 2,000 of the draws are linked with their nearest neighbours. Each climbs along links to a peak; two peaks are
/// one mode unless every path between them descends, from the lower peak, by 2 or more in ln density. What holds less
/// than 1 % of the draws belongs to the nearest mode.
///
/// @param points       [draw x dimension]
/// @param log_density  at each of them, to within a constant [draw]
/// Source: [Chazal2013].
Eigen::VectorXi find_modes(const Eigen::Ref<const Eigen::MatrixXd>& points,
                           const Eigen::Ref<const Eigen::VectorXd>& log_density);

}  // namespace mottle::updating
