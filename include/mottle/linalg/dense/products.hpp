// Matrix products by the BLAS library: this project's own code is compiled for the oldest processors it runs on, while
// the library chooses its kernels at run time.
#pragma once

#include <Eigen/Core>

#include "mottle/linalg/one_thread.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// C = alpha op(A) B + beta C, column-major; op transposes where asked.
void multiply(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& a, bool transposes_a,
              const Eigen::Ref<const Eigen::MatrixXd>& b, double beta, Eigen::Ref<Eigen::MatrixXd> c);

/// A B.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b);

/// A B, row by row; A has columns.
VectorRows product_by_rows(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b);

/// A' B.
Eigen::MatrixXd transposed_product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                   const Eigen::Ref<const Eigen::MatrixXd>& b);

/// A matrix by rows, padded with columns of zeros to the next width that kernels take.
VectorRows to_rows(const Eigen::Ref<const Eigen::MatrixXd>& vectors);

/// A' B of a small A [column of A x column of B]: for sizes of which a BLAS spends most of its time on preparations. A
/// row's bits do not depend on the other columns of A.
///
/// @param b  padded
VectorRows transposed_product_by_rows(const Eigen::Ref<const Eigen::MatrixXd>& a, const VectorRows& b);

/// Whether |a_ij| <= 1e-11 sqrt(a_ii a_jj) beside the diagonal of a symmetric matrix: y'Ay is that of the diagonal but
/// for rounding.
bool is_nearly_diagonal(const Eigen::Ref<const Eigen::MatrixXd>& a);

}  // namespace mottle::linalg
