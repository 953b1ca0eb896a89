// How likelihood ratios scatter in small samples where no candidate is missing: replications of the linear models.
#pragma once

#include "mottle/layers.hpp"
#include "updating/diagnosis/candidate_fits.hpp"

namespace mottle::updating {

/// One try of a candidate beside a set.
struct CandidateTry {
  Eigen::Index candidate = 0;
  CandidateFit* fit = nullptr;
};

/// Replaces the p-values of some tries by those of a parametric bootstrap, where these are larger. With few specimens
/// chi-squared is too narrow for a likelihood ratio of plain maximum likelihood.
///
/// Specimens are drawn from the linear random-effects model of the set alone (its restricted estimates, the specimens'
/// own sensitivities and noise), and the set with and without the candidate is fitted to each draw. Up to a tail of
/// 10 % the p-value is the fraction of draws beyond the observed ratio; further out the tail is continued by
///
///   p = 0.1 exp( -(x - x90) / m ),     m the mean excess of the draws over x90:
///
/// the ratio of a linear normal model is N log(1 + F k / nu), whose tail is exponential.
///
/// @param derivatives  of fits.derivatives_at(base, set)
/// Source: [Davison1997], ch. 4.
void refer_to_replications(const CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                           const std::vector<Eigen::MatrixXd>& derivatives, const std::vector<CandidateTry>& tries);

}  // namespace mottle::updating
