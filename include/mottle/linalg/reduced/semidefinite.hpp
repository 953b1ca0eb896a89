// Whether a sparse symmetric matrix is positive semidefinite.
#pragma once

#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// Whether T + k_inertia_tolerance diag(T) has no negative eigenvalue, by the pivots of its factor on T's own rows.
///
/// @param lower  T, lower triangle, compressed
bool is_semidefinite(const SparseMatrix& lower);

}  // namespace mottle::linalg
