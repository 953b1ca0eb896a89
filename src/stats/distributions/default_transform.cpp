#include "mottle/stats/distributions/default_transform.hpp"

namespace mottle::stats {

ParameterTransform default_transform(const DistributionSpec& prior) {
  using Kind = ParameterTransform::Kind;
  switch (prior.kind) {
    case DistributionKind::lognormal:
      return {.kind = Kind::log};
    case DistributionKind::beta:
      return {.kind = Kind::logit, .lower = prior.lower, .upper = prior.upper};
    case DistributionKind::normal:
    case DistributionKind::uniform:
    case DistributionKind::truncated_normal:
    case DistributionKind::gamma:
      break;
  }
  return {.kind = Kind::identity};
}

}  // namespace mottle::stats
