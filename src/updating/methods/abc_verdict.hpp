// How the scatter of the updated cloud comes out in studies of `abc` that are simulated with the right model.
#pragma once

#include "mottle/layers.hpp"
#include "updating/methods/abc_report.hpp"
#include "updating/verdict/simulated_law.hpp"

namespace mottle::updating {

/// Statistic of the verdict's test scatter-agreement for the tests and for each study of the calibration. Both are
/// estimated by the same search on the same cloud, so that what the search and the cloud are off by is in both. No
/// model is run.
StudiedStatistic studied_cloud_scatter(const AbcFit& fit, const SampledPopulations& sampled);

}  // namespace mottle::updating
