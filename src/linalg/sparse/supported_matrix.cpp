#include "linalg/sparse/supported_matrix.hpp"

namespace mottle::linalg {

SupportedMatrix::SupportedMatrix(const SparseMatrix& lower) {
  std::vector<int> local_row(static_cast<std::size_t>(lower.rows()), -1);
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      local_row[static_cast<std::size_t>(entry.row())] = 0;
      local_row[static_cast<std::size_t>(j)] = 0;
    }
  }
  for (std::size_t i = 0; i < local_row.size(); ++i) {
    if (local_row[i] < 0) continue;
    local_row[i] = static_cast<int>(rows_.size());
    rows_.push_back(static_cast<int>(i));
  }
  const auto order = static_cast<Eigen::Index>(rows_.size());
  lower_.resize(order, order);
  lower_.reserve(lower.nonZeros());
  for (Eigen::Index j = 0; j < order; ++j) {
    lower_.startVec(j);
    for (SparseMatrix::InnerIterator entry(lower, rows_[static_cast<std::size_t>(j)]); entry; ++entry) {
      lower_.insertBack(local_row[static_cast<std::size_t>(entry.row())], j) = entry.value();
    }
  }
  lower_.finalize();
}

simd_kernels::SparseLower SupportedMatrix::view() const {
  return {static_cast<int>(lower_.cols()), lower_.outerIndexPtr(), lower_.innerIndexPtr(), lower_.valuePtr(),
          rows_.data()};
}

void SupportedMatrix::add_scaled_product(const VectorRows& x, const Eigen::VectorXd& scales, VectorRows& result) const {
  simd_kernels::kernels_for().add_scaled_product(view(), scales.data(), static_cast<int>(x.cols()), x.data(),
                                                 result.data());
}

VectorRows SupportedMatrix::local_product(const VectorRows& x) const {
  VectorRows result = VectorRows::Zero(lower_.cols(), x.cols());
  if (lower_.cols() == 0) return result;
  VectorRows rest = result;
  simd_kernels::kernels_for().add_local_product(view(), static_cast<int>(x.cols()), x.data(), result.data(),
                                                rest.data());
  return result + rest;
}

VectorRows SupportedMatrix::project(const double* left, Eigen::Index vectors, Eigen::Index row_step,
                                    Eigen::Index vector_step, const VectorRows& product) const {
  VectorRows result = VectorRows::Zero(vectors, product.cols());
  if (rows_.empty()) return result;
  simd_kernels::kernels_for().add_gathered_product(
      {static_cast<int>(vectors), left, row_step, vector_step, static_cast<int>(rows_.size()), rows_.data()},
      static_cast<int>(product.cols()), product.data(), result.data());
  return result;
}

VectorRows SupportedMatrix::project(const Eigen::MatrixXd& left, const VectorRows& product) const {
  return project(left.data(), left.cols(), 1, left.outerStride(), product);
}

VectorRows SupportedMatrix::project(const VectorRows& left, const VectorRows& product) const {
  return project(left.data(), left.cols(), left.cols(), 1, product);
}

void SupportedMatrix::add_rows(double factor, const VectorRows& product, VectorRows& result) const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    result.row(rows_[i]) += factor * product.row(static_cast<Eigen::Index>(i));
  }
}

void SupportedMatrix::add_to(SparseMatrix& sum, double factor) const {
  for (Eigen::Index j = 0; j < lower_.cols(); ++j) {
    int k = sum.outerIndexPtr()[rows_[static_cast<std::size_t>(j)]];
    for (SparseMatrix::InnerIterator entry(lower_, j); entry; ++entry) {
      const int row = rows_[static_cast<std::size_t>(entry.row())];
      while (sum.innerIndexPtr()[k] < row) ++k;
      sum.valuePtr()[k] += factor * entry.value();
    }
  }
}

void add_weighted_products(const std::vector<SupportedMatrix>& terms, const Eigen::MatrixXd& weights,
                           const VectorRows& x, VectorRows& result) {
  Eigen::VectorXd scales = Eigen::VectorXd::Zero(x.cols());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    scales.head(weights.cols()) = weights.row(static_cast<Eigen::Index>(t)).transpose();
    if (!terms[t].is_empty()) terms[t].add_scaled_product(x, scales, result);
  }
}

}  // namespace mottle::linalg
