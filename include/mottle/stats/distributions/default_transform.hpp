// The scale on which a population is taken as normal where none is stated.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/distribution.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"

namespace mottle::stats {

/// The scale of a parameter that goes with its prior: log for a log-normal one, logit for a beta one, identity else.
///
/// A logit is taken between the ends of the prior, beyond which no specimen lies. The ends of a uniform or truncated
/// prior, as a parameter's bounds, are limits of the mean: specimens may lie beyond, and a logit would deny them.
ParameterTransform default_transform(const DistributionSpec& prior);

}  // namespace mottle::stats
