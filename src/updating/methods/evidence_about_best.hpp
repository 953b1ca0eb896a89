// The evidence of a posterior whose noise is not known, by draws that reach the lowest levels of the noise.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/chains/evidence_comparison.hpp"
#include "updating/methods/linear_noise.hpp"

namespace mottle::updating {

/// An importance sample's evidence.
struct EvidenceAboutBest : EstimatedEvidence {
  double pareto_k = 0.0;  ///< of its weights, which have no variance where it is above 1 / 2
};

/// ln Z by importance sampling about the parameters that meet the tests best, of each mode as often; nothing: the noise
/// is known, the parameters can meet any such tests, or the model fails there.
///
/// Where as many values are measured as parameters and one more, p(level | z) falls as 1 / level from the prior's scale
/// down to what the parameters leave of the tests: all of a hundred decades count alike, and a sampler that comes from
/// above hardly gets there. These draws come from below. Each level is drawn from its density by linear theory (see
/// LinearNoise) with the others at their medians, or with a probability of 1 / 10 from its prior, and the parameters'
/// scores from a t distribution of 5 degrees of freedom about what linear theory has given the levels, q the mixture of
/// all modes:
///
///   Z = mean of L(x) p(x) / q(x) over the draws, divided by the prior's probability of what is possible
///
/// It is unbiased whatever linear theory is worth, and too low where the posterior has mass far from these parameters,
/// so that an evidence above the sampler's shows what that lacks.
///
/// @param peaks        one of each mode, at least one, from which the best parameters are sought
/// @param levels       of the sampler's draws [draw x level]
/// @param target       the likelihood, by scores of parameters and levels
/// @param evaluations  raised by the model runs that were needed, those of `target` left out
std::optional<EvidenceAboutBest> evidence_about_best(const UpdatingProblem& problem, const NoiseLevels& noise,
                                                     const CommonLikelihood& likelihood,
                                                     const std::vector<PosteriorPeak>& peaks,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& levels,
                                                     const SamplingTarget& target, const RunContext& context,
                                                     std::int64_t& evaluations);

}  // namespace mottle::updating
