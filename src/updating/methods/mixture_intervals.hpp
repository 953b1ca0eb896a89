// Intervals of batches and of all of them together by parametric bootstrap.
#pragma once

#include "mottle/layers.hpp"
#include "updating/population/mixture_fit.hpp"

namespace mottle::updating {

/// Fills the intervals of `batches`, and gives those of the whole mixture, 95 %, on the parameters' own axes.
///
/// With T = n_k A_k^-1, the scatter of a batch with the noise's share, what redrawn specimens show of it gives back
/// what the tests may have shown (mean m, * redrawn):
///
///   m_b = m - (m* - m) sqrt(T n* / (T* n_k)),   v_b = max(T^2 / T* - (T - Sigma_k), 0),   w_b = w*
///
/// Ends are quantiles of the moments of these. With one batch and no noise they tend to Student's and chi-squared's.
ParameterIntervals mixture_intervals(const UpdatingProblem& problem, const MixturePopulationFit& fit,
                                     const std::vector<MixtureFit>& redrawn, std::vector<Batch>& batches);

}  // namespace mottle::updating
