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

}  // namespace mottle::linalg
