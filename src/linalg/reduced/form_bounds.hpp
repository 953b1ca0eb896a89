// Bounds of one quadratic form by another, each proven by a factorisation without negative pivots.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "linalg/sparse/supported_matrix.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// lower P <= T <= upper P as quadratic forms; infinite where nothing is proven.
struct FormBounds {
  double lower = 0.0, upper = 0.0;
};

/// Whether T + k_inertia_tolerance diag(T) has no negative eigenvalue, by the pivots of its factor on T's own rows.
///
/// @param order  elimination order of all rows, if known; empty: one is computed
bool is_semidefinite(const SupportedMatrix& term, const std::vector<int>& order = {});

/// Bounds of T by P: extreme eigenvalues of T x = theta P x by Lanczos' method, moved outwards until
/// T - lower P and upper P - T are factorised without a negative pivot.
///
/// @param form    P, lower triangle, in a pattern that holds T's
/// @param factor  of P
/// @param start   of the Lanczos vectors
/// Source: [Parlett1998], ch. 13; Sylvester's law of inertia.
FormBounds verified_bounds(const SparseMatrix& term, const SparseMatrix& form, DefiniteFactor& factor,
                           const Eigen::VectorXd& start);

/// Lower bound of sum_t values_t T_t against P = sum_t reference_t T_t, given bounds of each term against P: the
/// largest alpha found with
///
///   sum values_t T_t >= alpha P,   alpha = max over r of  r + sum_t min(c_t lower_t, c_t upper_t),
///                                  c_t = values_t - r reference_t.
///
/// Concave and piecewise linear in r: the maximum is at a corner. -infinity where nothing is known.
///
/// @param bounds  lower and upper [term x 2]
double lower_ratio(const Eigen::Ref<const Eigen::VectorXd>& values, const Eigen::VectorXd& reference,
                   const Eigen::MatrixXd& bounds);

/// The smallest beta found with sum values_t T_t <= beta P; infinity where nothing is known.
double upper_ratio(const Eigen::Ref<const Eigen::VectorXd>& values, const Eigen::VectorXd& reference,
                   const Eigen::MatrixXd& bounds);

}  // namespace mottle::linalg
