#include "linalg/batched/symmetric_product.hpp"

#include <algorithm>

#include "linalg/batched/simd_kernels.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::linalg {

constexpr Eigen::Index k_rows = 64;  // at a time: the columns' parts stay in the cache

Eigen::Index padded_width(Eigen::Index vectors) {
  constexpr Eigen::Index k_padding = simd_kernels::k_vector_padding;
  return (vectors + k_padding - 1) / k_padding * k_padding;
}

VectorRows to_rows(const Eigen::Ref<const Eigen::MatrixXd>& vectors) {
  const Eigen::Index width = padded_width(vectors.cols());
  VectorRows rows(vectors.rows(), width);
  rows.rightCols(width - vectors.cols()).setZero();
  for (Eigen::Index first = 0; first < vectors.rows(); first += k_rows) {
    const Eigen::Index count = std::min(k_rows, vectors.rows() - first);
    rows.block(first, 0, count, vectors.cols()) = vectors.middleRows(first, count);
  }
  return rows;
}

Eigen::MatrixXd to_columns(const VectorRows& rows, Eigen::Index count) {
  Eigen::MatrixXd vectors(rows.rows(), count);
  for (Eigen::Index first = 0; first < rows.rows(); first += k_rows) {
    const Eigen::Index many = std::min(k_rows, rows.rows() - first);
    vectors.middleRows(first, many) = rows.block(first, 0, many, count);
  }
  return vectors;
}

Eigen::MatrixXd product_of_rows(const VectorRows& left, const VectorRows& right) {
  if (left.cols() > right.cols()) return product_of_rows(right, left).transpose();  // many fill the registers better
  VectorRows result = VectorRows::Zero(left.cols(), right.cols());
  simd_kernels::kernels_for().add_gathered_product(
      {static_cast<int>(left.cols()), left.data(), left.cols(), 1, static_cast<int>(left.rows()), nullptr},
      static_cast<int>(right.cols()), right.data(), result.data());
  return result;
}

VectorRows product_rows(const SparseMatrix& lower, const VectorRows& x) {
  VectorRows product = VectorRows::Zero(x.rows(), x.cols());
  simd_kernels::kernels_for().add_symmetric_product(
      {static_cast<int>(lower.cols()), lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr()},
      static_cast<int>(x.cols()), x.data(), product.data());
  return product;
}

Eigen::VectorXd sums_of_terms(const SparseMatrix& lower, const Eigen::Ref<const Eigen::MatrixXd>& shapes) {
  const Eigen::MatrixXd sizes = shapes.cwiseAbs();
  return sizes.cwiseProduct(symmetric_product(lower.cwiseAbs(), sizes)).colwise().sum().transpose();
}

Eigen::MatrixXd symmetric_product(const SparseMatrix& lower, const Eigen::Ref<const Eigen::MatrixXd>& x) {
  return to_columns(product_rows(lower, to_rows(x)), x.cols());
}

}  // namespace mottle::linalg
