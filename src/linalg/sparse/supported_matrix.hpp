// A sparse symmetric matrix that acts on part of the equations: one term of a pencil, one patch of a structure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "linalg/batched/simd_kernels.hpp"
#include "linalg/batched/symmetric_product.hpp"

namespace mottle::linalg {

/// The rows that hold entries, and the lower triangle among them.
class SupportedMatrix {
 public:
  explicit SupportedMatrix(const SparseMatrix& lower);

  bool is_empty() const { return rows_.empty(); }
  /// The lower triangle among the rows that hold entries.
  const SparseMatrix& local() const { return lower_; }
  /// Which these rows are, ascending.
  const std::vector<int>& rows() const { return rows_; }

  /// result += A x diag(scales); both [equation x vector], a scale for each of the padding too.
  void add_scaled_product(const VectorRows& x, const Eigen::VectorXd& scales, VectorRows& result) const;

  /// The rows of A x that can hold anything; as if found in twice the precision and rounded once, since the terms of a
  /// stiff structure's nearly rigid motions cancel.
  VectorRows local_product(const VectorRows& x) const;
  /// left' A x from local_product(x): [left vector x vector].
  VectorRows project(const Eigen::MatrixXd& left, const VectorRows& product) const;
  /// The same with left vectors that lie row by row.
  VectorRows project(const VectorRows& left, const VectorRows& product) const;

  /// result += factor A x from local_product(x); result is [equation x vector].
  void add_rows(double factor, const VectorRows& product, VectorRows& result) const;

  /// sum += factor A; the pattern of `sum` holds A's.
  void add_to(SparseMatrix& sum, double factor) const;

 private:
  simd_kernels::SparseLower view() const;
  /// left' A x where a step leads from one row, or vector, of `left` to the next.
  VectorRows project(const double* left, Eigen::Index vectors, Eigen::Index row_step, Eigen::Index vector_step,
                     const VectorRows& product) const;

  std::vector<int> rows_;  // ascending
  SparseMatrix lower_;
};

/// result += sum of term * x * diag(weights of the term); x and result are [equation x vector].
///
/// @param weights  [term x vector], as many vectors as x has without its padding
void add_weighted_products(const std::vector<SupportedMatrix>& terms, const Eigen::MatrixXd& weights,
                           const VectorRows& x, VectorRows& result);

}  // namespace mottle::linalg
