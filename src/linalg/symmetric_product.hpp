// Products of sparse symmetric matrices with blocks of vectors that lie row by row, as the kernels want them.
#pragma once

#include <Eigen/Core>

#include "mottle/linalg/symmetric_factor.hpp"

namespace mottle {

/// [row x vector], row by row; the number of vectors is a multiple of 8.
using VectorRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Vectors side by side, with their padding of zeros.
VectorRows to_rows(const Eigen::Ref<const Eigen::MatrixXd>& vectors);

/// The first `count` of vectors that lie row by row, side by side.
Eigen::MatrixXd to_columns(const VectorRows& rows, Eigen::Index count);

/// A x for the symmetric A given by its lower triangle, compressed.
VectorRows product_rows(const SparseMatrix& lower, const VectorRows& x);

}  // namespace mottle
