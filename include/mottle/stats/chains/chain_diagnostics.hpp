// Whether chains of draws agree with each other, and how many independent draws they are worth.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Rank-normalised split R-hat: near 1 where all halves of all chains have the same location and the same spread.
///
///   max(R(z(x)), R(z(|x - median|))),   R^2 = (B / n + (n - 1) / n W) / W
///
/// z: normal scores of the ranks over all draws, (rank - 3/8) / (S + 1/4); W: mean of the variances of the half
/// chains, B / n: variance of their means.
///
/// @param draws  [draw x chain], >= 4 draws
/// @return       nan: too few draws, a draw that is not finite, or all draws equal
/// Source: [Vehtari2021], Eqs. 1 to 4 and 14.
double rank_normalised_r_hat(const Eigen::Ref<const Eigen::MatrixXd>& draws);

/// Number of independent draws that the location is known as well from: of the normal scores of split chains.
///
///   S / tau,   tau = -1 + 2 sum of Geyer's initial monotone sequence of autocorrelations
///
/// @param draws  [draw x chain]
/// @return       at most S log10(S); nan as rank_normalised_r_hat()
/// Source: [Vehtari2021], Eqs. 10 to 13; [Geyer1992].
double bulk_effective_sample_size(const Eigen::Ref<const Eigen::MatrixXd>& draws);

/// The same of the 5 % and the 95 % quantile, the smaller of both.
/// Source: [Vehtari2021], section 4.3.
double tail_effective_sample_size(const Eigen::Ref<const Eigen::MatrixXd>& draws);

}  // namespace mottle::stats
