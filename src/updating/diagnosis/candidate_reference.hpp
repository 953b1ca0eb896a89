// How likelihood ratios scatter in small samples where no candidate is missing: replications of the linear models.
#pragma once

#include "mottle/layers.hpp"
#include "updating/diagnosis/candidate_fits.hpp"

namespace mottle::updating {

/// One try of a candidate beside a set.
struct CandidateTry {
  Eigen::Index candidate = 0;
  CandidateFit* fit = nullptr;
  CandidateEffects effects = {};  ///< of CandidateFits::effects_at_specimens()
};

/// Replaces the p-values of some tries by those of a parametric bootstrap, where these are larger. With few specimens
/// chi-squared is too narrow for a likelihood ratio of plain maximum likelihood.
///
/// Specimens are drawn from the linear random-effects model of the set alone (its restricted estimates, the specimens'
/// own sensitivities and noise), and the set with and without the candidate is fitted to each draw; the p-value is
/// RatioDraws::upper_tail(). The ratio of a linear normal model is N log(1 + F k / nu), whose tail is exponential.
///
/// There are 400 draws, in blocks of 100. A try is left out of further ones as soon as RatioDraws::decide() says that
/// they could not change its significance at any of Holm's levels, from level / (2 candidates) to level.
///
/// @param candidates  number of all candidates, each of which is tried in two kinds
/// Source: [Davison1997], ch. 4; sequential stop after [Besag1991].
void refer_to_replications(const CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                           std::size_t candidates, const std::vector<CandidateTry>& tries);

}  // namespace mottle::updating
