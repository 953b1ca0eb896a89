// Whether the draws of a posterior reach the lowest levels of the noise that it has.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/methods/bayes_tests.hpp"
#include "updating/methods/posterior_target.hpp"

namespace mottle::updating {

/// Of each level of the noise the probability that its draws lack towards low levels: the most by which that below
/// their quantiles of 0.5, 5 and 25 % exceeds these, with the other levels at their medians, by linear theory about the
/// parameters that meet the tests best:
///
///   p(level | z) ~ p(level) N(z; f - J u, R + D + J J') prod_k r_k^(-(n_k - 1) / 2) exp(-S_k / 2 r_k)
///
/// u the parameters' scores there, J = df/du, R and D the variances of the tests' means by noise and the model's error,
/// n_k tests with the sum of squares S_k about their mean. Where as many values are measured as parameters and one
/// more, p falls as 1 / level from the prior's scale down to what the parameters leave of the tests: all of a hundred
/// decades count alike, and a sampler that comes from above does not get there.
///
/// @param peak         from which the best parameters are sought
/// @param levels       of the draws [draw x level]
/// @param evaluations  raised by the model runs that were needed
/// @return             [level]
std::vector<double> unreached_levels(const UpdatingProblem& problem, const NoiseLevels& noise,
                                     const CommonLikelihood& likelihood, const PosteriorPeak& peak,
                                     const Eigen::Ref<const Eigen::MatrixXd>& levels, const RunContext& context,
                                     std::int64_t& evaluations);

}  // namespace mottle::updating
