// Factorisations of sparse symmetric matrices behind one interface, so that the package behind it can be changed.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

namespace mottle::linalg {

/// A sparse symmetric matrix by its lower triangle, compressed columns.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// Vectors side by side, row by row: [row x vector].
using VectorRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// P A P' = L D L' of a sparse symmetric matrix. The order P is found at the first call and kept for later matrices of
/// the same pattern.
class SymmetricFactor {
 public:
  virtual ~SymmetricFactor() = default;

  /// Factorises `lower`; false where it cannot be done (see failed_column()).
  ///
  /// @param lower  lower triangle of A, compressed; the pattern of the first call is the pattern of all
  virtual bool factorise(const SparseMatrix& lower) = 0;

  /// Solves A X = B in place, all right-hand sides in one sweep.
  virtual void solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) = 0;

  /// Number of negative eigenvalues of A (Sylvester's law of inertia). Source: [Wilkinson1965], ch. 5.
  virtual int negative_eigenvalues() const = 0;

  /// Row of A at which the last factorisation broke down, or -1.
  virtual int failed_column() const { return -1; }

  /// Entries of L.
  virtual double factor_entries() const = 0;

  /// "CHOLMOD supernodal", "MUMPS".
  virtual std::string name() const = 0;
};

/// P A P' = L L' of a positive definite matrix. Solutions may be asked for by several threads at once.
class DefiniteFactor : public SymmetricFactor {
 public:
  /// solve() for right-hand sides that lie row by row, as the sweep takes them.
  virtual void solve_rows(Eigen::Ref<VectorRows> right_hand_sides) = 0;

  /// P: rows of A in the order of elimination; empty before the first factorisation.
  virtual std::vector<int> order() const = 0;

  /// X = P' L^-T B in place: A^-1 = S S' with S = P' L^-T.
  virtual void solve_root(Eigen::Ref<VectorRows> right_hand_sides) = 0;
};

/// CHOLMOD's supernodal code with METIS ordering: the fast one.
///
/// @param order  P, if known; empty: one is computed
std::unique_ptr<DefiniteFactor> make_definite_factor(std::vector<int> order = {});

/// L D L' with pivoting of an indefinite matrix by MUMPS: the one that counts negative eigenvalues.
std::unique_ptr<SymmetricFactor> make_indefinite_factor();

}  // namespace mottle::linalg
