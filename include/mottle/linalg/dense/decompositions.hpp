// Decompositions of dense matrices of any size. Eigen's templates behind them are compiled here once for all layers:
// made anew in each source that needs one, they took a third of the time of a whole build.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <type_traits>

namespace mottle::linalg {

/// Eigenvalues and eigenvectors of a symmetric matrix A = V diag(lambda) V'.
class SymmetricEigen {
 public:
  /// @param matrix  [n x n], symmetric; its lower triangle is read
  explicit SymmetricEigen(const Eigen::MatrixXd& matrix);
  /// Of the tridiagonal matrix with these entries [n], [n - 1].
  SymmetricEigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& subdiagonal);

  const Eigen::VectorXd& eigenvalues() const { return eigenvalues_; }  ///< ascending [n]
  bool has_converged() const { return has_converged_; }
  const Eigen::MatrixXd& eigenvectors() const { return eigenvectors_; }  ///< orthonormal columns [n x n]

 private:
  Eigen::VectorXd eigenvalues_;
  Eigen::MatrixXd eigenvectors_;
  bool has_converged_ = false;
};

/// Eigenvalues alone, ascending, of a symmetric matrix of which the lower triangle is read.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

/// One column, or many.
template <typename Derived>
using ColumnsOf = std::conditional_t<Derived::ColsAtCompileTime == 1, Eigen::VectorXd, Eigen::MatrixXd>;

/// Cholesky factor L of a symmetric positive definite matrix A = L L'.
class CholeskyFactor {
 public:
  CholeskyFactor() = default;
  /// @param matrix  [n x n]; its lower triangle is read
  explicit CholeskyFactor(const Eigen::MatrixXd& matrix);

  /// Whether the matrix was positive definite; if not, the factor means nothing.
  bool is_positive_definite() const { return is_positive_definite_; }
  Eigen::MatrixXd lower() const { return factor_.triangularView<Eigen::Lower>(); }  ///< L
  double log_determinant() const { return 2.0 * factor_.diagonal().array().log().sum(); }

  /// A^-1 b.
  template <typename Derived>
  auto solve(const Eigen::MatrixBase<Derived>& right) const {
    ColumnsOf<Derived> solution = right;
    solve_in_place(solution);
    return solution;
  }
  /// L^-1 b: what has the covariance A becomes independent of variance 1.
  template <typename Derived>
  auto solve_lower(const Eigen::MatrixBase<Derived>& right) const {
    ColumnsOf<Derived> solution = right;
    solve_lower_in_place(solution);
    return solution;
  }
  void solve_lower_in_place(Eigen::MatrixXd& columns) const;
  void solve_lower_in_place(Eigen::VectorXd& column) const;
  /// L'^-1 b.
  void solve_upper_in_place(Eigen::MatrixXd& columns) const;

 private:
  void solve_in_place(Eigen::MatrixXd& columns) const;
  void solve_in_place(Eigen::VectorXd& column) const;

  Eigen::MatrixXd factor_;  // L in the lower triangle
  bool is_positive_definite_ = false;
};

void solve_semidefinite_in_place(const Eigen::MatrixXd& matrix, Eigen::MatrixXd& columns);
void solve_semidefinite_in_place(const Eigen::MatrixXd& matrix, Eigen::VectorXd& column);
/// A^-1 b of a symmetric semi-definite matrix by a pivoted factor L D L'; directions without D are left out.
template <typename Derived>
auto solve_semidefinite(const Eigen::MatrixXd& matrix, const Eigen::MatrixBase<Derived>& right) {
  ColumnsOf<Derived> solution = right;
  solve_semidefinite_in_place(matrix, solution);
  return solution;
}
/// D of that factor, in the order of its pivots.
Eigen::VectorXd semidefinite_pivots(const Eigen::MatrixXd& matrix);

/// Pseudo-inverse of a covariance or information matrix whose rows have different units: D R^+ D with the correlations
/// R = D A D, D = diag(A)^-1/2, so that no unit changes its rank.
Eigen::MatrixXd semidefinite_pseudo_inverse(const Eigen::MatrixXd& matrix);

/// A^-1 of a general square matrix by a factor with partial pivoting.
Eigen::MatrixXd inverse_by_lu(const Eigen::MatrixXd& matrix);

/// Householder factor A P = Q R with column pivoting.
class PivotedQr {
 public:
  /// @param threshold  pivots count as zero below this fraction of the largest; nothing: rounding
  explicit PivotedQr(const Eigen::MatrixXd& matrix, std::optional<double> threshold = {});

  Eigen::Index rank() const;
  Eigen::VectorXd diagonal() const;           ///< of R, by falling magnitude
  Eigen::Index column(Eigen::Index k) const;  ///< which column of A the k-th of A P is
  Eigen::MatrixXd range() const;              ///< orthonormal basis of what the columns span [row x rank]
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;  ///< in the sense of least squares
  Eigen::MatrixXd inverse() const;                            ///< of a square matrix of full rank

 private:
  struct Factor;
  std::shared_ptr<const Factor> factor_;
};

/// The first columns of Q in A = Q R, without pivoting [row x column of A], rows >= columns.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& matrix);

/// Least-squares solutions of least norm by a complete orthogonal decomposition.
class LeastNormSolver {
 public:
  /// @param threshold  pivots count as zero below this fraction of the largest; nothing: rounding
  explicit LeastNormSolver(const Eigen::MatrixXd& matrix, std::optional<double> threshold = {});

  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd pseudo_inverse() const;

 private:
  struct Factor;
  std::shared_ptr<const Factor> factor_;
};

/// Singular values and vectors A = U diag(s) V', by Jacobi rotations: small values are as accurate as large ones.
class SingularValues {
 public:
  /// @param vectors  Eigen::ComputeThinU, ComputeThinV, ComputeFullU, ComputeFullV, or'ed; 0: values alone
  explicit SingularValues(const Eigen::MatrixXd& matrix, unsigned vectors = 0);

  const Eigen::VectorXd& values() const { return values_; }  ///< falling
  const Eigen::MatrixXd& left() const { return left_; }      ///< U
  const Eigen::MatrixXd& right() const { return right_; }    ///< V
  Eigen::Index rank() const { return rank_; }                ///< values above rounding

 private:
  Eigen::VectorXd values_;
  Eigen::MatrixXd left_;
  Eigen::MatrixXd right_;
  Eigen::Index rank_ = 0;
};

}  // namespace mottle::linalg
