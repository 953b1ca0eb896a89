// How far Ritz values can be above the eigenvalues, from their residuals.
#pragma once

#include <Eigen/Core>

namespace mottle {

/// Bounds on the relative errors of the lowest Ritz values mu_1 <= mu_2 <= ... of a definite pencil (A, M):
///
///   mu_k (1 - e_k) <= lambda_k <= mu_k,
///   e_k = min over p >= k of  [g_kk + sum_{j<=p, j!=k} min(c_kj, c_kj^2 / |1 - mu_k / mu_j|)] / (1 - mu_k / nu_p),
///   g_kj = r_k' A^-1 r_j / sqrt(mu_k mu_j),  c_kj = g_kj mu_k / mu_j,
///   nu_p = mu_{p+1} less what its own residual may hide.
///
/// Kato and Temple's bound in the A^-1 M form with the lowest p Ritz vectors as one space: close or equal eigenvalues
/// among them need no gap between each other, only the next one above must keep away. Infinite where it does not, where
/// its residual is large, or where the bound would be: such a space may miss a mode.
///
/// The coupling of modes is taken to second order: true errors exceed e by up to a fifth in rare cases, which the
/// caller's reserve in `gram` must cover.
///
/// @param values  mu [mode], positive, ascending; the last ones serve as `nu` only
/// @param gram    r_i' A^-1 r_j [mode x mode], an upper estimate
/// @param wanted  for how many of the lowest
/// @return        e [wanted]
/// Source: [Kato1949]; [Mathias1998], quadratic residual bounds.
Eigen::VectorXd error_bounds(const Eigen::Ref<const Eigen::VectorXd>& values,
                             const Eigen::Ref<const Eigen::MatrixXd>& gram, Eigen::Index wanted);

}  // namespace mottle
