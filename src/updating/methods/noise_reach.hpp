// Whether the draws of a posterior reach the lowest levels of the noise that it has.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/chains/evidence_comparison.hpp"
#include "updating/methods/linear_noise.hpp"

namespace mottle::updating {

/// What an importance sample and linear theory about the parameters that meet the tests best say of the sampler's.
struct NoiseReach {
  /// By importance sampling; nothing: it cannot tell.
  std::optional<EstimatedEvidence> evidence;
  /// Of each level the probability that its draws lack towards low levels: the most by which that below their quantiles
  /// of 0.5, 5 and 25 % exceeds these, with the other levels at their medians, by linear theory. Empty: not known.
  std::vector<double> missed;
};

/// Where as many values are measured as parameters and one more, p(level | z) falls as 1 / level from the prior's scale
/// down to what the parameters leave of the tests: all of a hundred decades count alike, and a sampler that comes from
/// above does not get there.
///
/// The importance sample draws each level from its density by linear theory (see LinearNoise), the others at their
/// medians, or with a probability of 1 / 10 from its prior, and the parameters' scores from a t distribution of 5
/// degrees of freedom about what linear theory has given the levels:
///
///   Z = mean of L(x) p(x) / q(x) over the draws, divided by the prior's probability of what is possible
///
/// It is unbiased whatever linear theory is worth, and too low where the posterior has mass far from these parameters,
/// so that an evidence above the sampler's shows what that lacks.
///
/// @param peak         from which the best parameters are sought
/// @param levels       of the draws [draw x level]
/// @param target       the likelihood, by scores of parameters and levels
/// @param evaluations  raised by the model runs that were needed, those of `target` left out
NoiseReach find_noise_reach(const UpdatingProblem& problem, const NoiseLevels& noise,
                            const CommonLikelihood& likelihood, const PosteriorPeak& peak,
                            const Eigen::Ref<const Eigen::MatrixXd>& levels, const SamplingTarget& target,
                            const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
