// Bounds of each output that the specimens show, and the wider ones that a stated fraction of the population keeps.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"

namespace mottle::updating {

/// Bounds of every output.
///
///   observed:           the smallest and the largest test
///   normal-tolerance:   mean -+ k s, see normal_tolerance_factor(), and no narrower than the observed
///   distribution-free:  the observed ones, where the specimens are enough for content and confidence
///
/// Measurement noise stays in them. Throws InvalidInput: an output with fewer than two measured values; too few
/// specimens for distribution-free limits (says how many are needed); a lower limit <= 0 of an output that is positive.
SpecimenBounds find_specimen_bounds(const UpdatingProblem& problem, const IntervalOptions& options);

}  // namespace mottle::updating
