// A sparse symmetric matrix that acts on part of the equations: one term of a pencil, one patch of a structure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "symmetric_product.hpp"

namespace mottle {

/// The rows that hold entries, and the lower triangle among them.
class SupportedMatrix {
 public:
  explicit SupportedMatrix(const SparseMatrix& lower);

  bool is_empty() const { return rows_.empty(); }

  /// result += A x diag(scales); both [equation x vector]; x is zero where it is padding.
  void add_scaled_product(const VectorRows& x, const Eigen::VectorXd& scales, VectorRows& result) const;

  /// The rows of A x that can hold anything.
  VectorRows local_product(const VectorRows& x) const;
  /// left' A x from local_product(x), dense: [left vector x vector]; the first `count` vectors.
  Eigen::MatrixXd project(const Eigen::Ref<const Eigen::MatrixXd>& left, const VectorRows& product,
                          Eigen::Index count) const;

  /// The same with left vectors that lie row by row.
  Eigen::MatrixXd project_rows(const VectorRows& left, const VectorRows& product, Eigen::Index count) const;

  /// sum += factor A; the pattern of `sum` holds A's.
  void add_to(SparseMatrix& sum, double factor) const;

 private:
  bool is_full(Eigen::Index rows) const { return static_cast<Eigen::Index>(rows_.size()) == rows; }

  std::vector<int> rows_;  // ascending
  SparseMatrix lower_;
};

/// result += sum of term * x * diag(weights of the term); x and result are [equation x vector].
///
/// @param weights  [term x vector], as many vectors as x has without its padding
void add_weighted_products(const std::vector<SupportedMatrix>& terms, const Eigen::MatrixXd& weights,
                           const VectorRows& x, VectorRows& result);

}  // namespace mottle
