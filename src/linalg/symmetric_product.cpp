#include "symmetric_product.hpp"

#include "linalg/lane_kernels.hpp"
#include "mottle/linalg/sparse_modes.hpp"

namespace mottle {

Eigen::Index padded_width(Eigen::Index width) {
  constexpr Eigen::Index k_padding = lane_kernels::k_vector_padding;
  return (width + k_padding - 1) / k_padding * k_padding;
}

VectorRows product_rows(const SparseMatrix& lower, const VectorRows& x) {
  VectorRows product = VectorRows::Zero(x.rows(), x.cols());
  lane_kernels::widest_kernels().add_symmetric_product(
      {static_cast<int>(lower.cols()), lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr()},
      static_cast<int>(x.cols()), x.data(), product.data());
  return product;
}

Eigen::MatrixXd symmetric_product(const SparseMatrix& lower, const Eigen::Ref<const Eigen::MatrixXd>& x) {
  VectorRows in = VectorRows::Zero(x.rows(), padded_width(x.cols()));
  in.leftCols(x.cols()) = x;
  return product_rows(lower, in).leftCols(x.cols());
}

}  // namespace mottle
