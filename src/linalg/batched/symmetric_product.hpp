// Products of sparse symmetric matrices with blocks of vectors that lie row by row, as the kernels want them.
#pragma once

#include <Eigen/Core>

#include "mottle/linalg/dense/products.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// The number of vectors that products work on: some of zeros fill up a multiple of 8.
Eigen::Index padded_width(Eigen::Index vectors);

/// The first `count` of vectors that lie row by row, side by side.
Eigen::MatrixXd to_columns(const VectorRows& rows, Eigen::Index count);

/// Inner products of all left vectors with all right ones, padding included: left' right.
Eigen::MatrixXd product_of_rows(const VectorRows& left, const VectorRows& right);

/// A x for the symmetric A given by its lower triangle, compressed.
VectorRows product_rows(const SparseMatrix& lower, const VectorRows& x);

}  // namespace mottle::linalg
