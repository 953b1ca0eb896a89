// Error bounds of Ritz values from their residuals.
#pragma once

#include <Eigen/Core>

namespace mottle::linalg {

/// Bounds on the relative errors of the lowest Ritz values mu_1 <= mu_2 <= ... of a definite pencil (A, M):
///
///   mu_k (1 - e_k) <= lambda_k <= mu_k,   e_k = min over p >= k of the root e of
///
///   sum_{j=k..p}  (mu_k / mu_j) s_j / (1 - mu_j / nu_p) / (e + 1 - mu_k / mu_j) = 1
///
/// with the relative squared residuals s_j and nu_p below all but p eigenvalues. It is Lehmann's bound with the lowest
/// p Ritz vectors as one space, its matrix bounded by the traces of its trailing parts: close or equal eigenvalues
/// among them need no gap between each other. For p = k it is Kato and Temple's s_k / (1 - mu_k / nu_k).
///
///   nu_p = min(mu_{p+1}, complement_bound), lowered by the coupling that the residual of Ritz vector p + 1 allows
///
/// Infinite where nu_p <= mu_k for all p, the residual of p + 1 is large, or the bound would be above 1 %.
///
/// @param values   mu [mode], positive, ascending; the last ones serve as `nu` only
/// @param squares  r_j' A^-1 r_j / mu_j, upper bounds; y' M y = 1 [mode]
/// @param complement_bound  lower bound of the Rayleigh quotient over vectors orthogonal to the Ritz vectors' space
/// @param wanted   number of lowest modes to bound
/// @param enough   a smaller bound is not sought for e_k below this: most samples' first bound, p = k, is
/// @return         e [wanted]
/// Source: [Kato1949]; [Lehmann1963]; docs/theory/reduced-model.md.
Eigen::VectorXd error_bounds(const Eigen::Ref<const Eigen::VectorXd>& values,
                             const Eigen::Ref<const Eigen::VectorXd>& squares, double complement_bound,
                             Eigen::Index wanted, double enough = 0.0);

}  // namespace mottle::linalg
