// The evidence of independent islands together, and of independent draws.
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

namespace mottle::updating {
namespace {

void state_interval(Evidence& evidence) {
  constexpr double k_tail = 0.025;
  const boost::math::students_t t(evidence.degrees_of_freedom);
  const double reach = evidence.standard_error * boost::math::quantile(boost::math::complement(t, k_tail));
  evidence.lower = evidence.log_evidence - reach;
  evidence.upper = evidence.log_evidence + reach;
}

}  // namespace

Evidence combine_evidence(const std::vector<SampledIsland>& islands) {
  const auto count = static_cast<double>(islands.size());
  require(islands.size() >= 2, "islands: {}, the evidence's error needs at least 2", islands.size());
  Eigen::ArrayXd logs(static_cast<Eigen::Index>(islands.size()));
  for (std::size_t i = 0; i < islands.size(); ++i) logs(static_cast<Eigen::Index>(i)) = islands[i].log_evidence;
  const double largest = logs.maxCoeff();
  const Eigen::ArrayXd relative = (logs - largest).exp();
  const double mean = relative.mean();
  const double variance = (relative - mean).square().sum() / (count - 1.0);
  Evidence evidence;
  evidence.log_evidence = largest + std::log(mean);
  evidence.standard_error = std::sqrt(variance / count) / mean;  // to first order of the logarithm
  evidence.degrees_of_freedom = count - 1.0;
  state_interval(evidence);
  evidence.spread = std::sqrt((logs - logs.mean()).square().sum() / (count - 1.0));
  return evidence;
}

void take_importance_evidence(const EstimatedEvidence& estimate, Evidence& evidence) {
  static_cast<EstimatedEvidence&>(evidence) = estimate;
  evidence.source = EvidenceSource::importance_sampling;
  state_interval(evidence);
}

}  // namespace mottle::updating
