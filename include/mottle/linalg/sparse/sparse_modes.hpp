// The lowest modes of one large sparse symmetric pencil, with a proof that none was missed.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "mottle/linalg/sparse/negative_mass.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// Options of the eigenvalue solution.
struct SparseModesOptions {
  int modes = 10;                           ///< how many of the lowest, >= 1
  double tolerance = 1e-10;                 ///< relative residual of the shift-inverted problem
  bool counts_below = false;                ///< factorise once more above the last mode and count the modes below
  bool measures = true;                     ///< finds the residuals, at the cost of a few products
  bool is_mass_semidefinite = false;        ///< known; else M is factorised to see it, unless it is diagonal
  const std::atomic<bool>* stop = nullptr;  ///< true: to be stopped, between two block steps or factorisations
};

/// The lowest modes, their residuals and the count of eigenvalues that verifies them.
struct SparseModes {
  Eigen::VectorXd values;     ///< lambda, ascending [mode]
  Eigen::MatrixXd vectors;    ///< phi' M phi = 1 [dof x mode]; the component of largest magnitude positive
  Eigen::VectorXd residuals;  ///< norm(K phi - lambda M phi) / norm(|K| |phi| + |lambda| |M| |phi|) [mode], if measured
  double shift = 0.0;         ///< of the factorisation, below all modes
  int counted_below = -1;     ///< modes below `counted_at` by the inertia of K - counted_at M; -1: not asked for
  double counted_at = 0.0;    ///< between the last mode and the next, or below the root they share
  int basis_vectors = 0;      ///< solves with the factor
  double factor_seconds = 0.0;                ///< of the first factorisation, its ordering included
  std::string failure;                        ///< why there is no result; empty where there is one
  int failed_row = -1;                        ///< row of the matrices to which the failure belongs, or -1
  bool is_massless = false;                   ///< the failed row
  std::optional<NegativeMass> negative_mass;  ///< where that is the failure

  /// Whether the count agrees with the modes found (true where it was not asked for).
  bool is_complete() const { return counted_below < 0 || counted_below == values.size(); }
};

/// Number of eigenvalues of K phi = lambda M phi below `value`, by the inertia of K - value M; -1: the factorisation
/// failed.
///
/// @param stiffness, mass  lower triangles, compressed
int count_eigenvalues_below(const SparseMatrix& stiffness, const SparseMatrix& mass, double value);

/// Solver for the lowest modes of pencils; for pencils of one sparsity pattern the symbolic factorisation is kept.
///
///   K phi = lambda M phi,   (K - s M)^-1 M phi = phi / (lambda - s),   s below all modes
///
/// Block Lanczos on the shift-inverted operator with full reorthogonalisation in the M inner product and thick
/// restarts. K positive semidefinite (rigid-body modes and repeated roots are found), M positive semidefinite
/// (massless degrees of freedom are no modes); where it is not, see find_negative_mass(), there are none. Fewer modes
/// than asked for come back where the pencil has no more. Not for use by two threads at once. Same pencil, same
/// numbers.
/// Source: [Grimes1994]; [GolubVanLoan2013], section 10.3; restarts [Wu2000].
class SparseModeSolver {
 public:
  SparseModeSolver();
  SparseModeSolver(SparseModeSolver&&) noexcept;
  SparseModeSolver& operator=(SparseModeSolver&&) noexcept;
  ~SparseModeSolver();

  /// @param stiffness, mass  lower triangles, compressed; another pattern than before costs a symbolic factorisation
  /// @throws InvalidInput    shapes that do not fit, modes < 1
  /// @throws SystemFailure   not enough memory
  /// @throws Stopped         on request
  SparseModes solve(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseModesOptions& options);

  /// Makes the factor of K - shift M alone, as solve() would: the same numbers.
  ///
  /// @return  the shift; 0 where none makes the matrix definite
  double factorise(const SparseMatrix& stiffness, const SparseMatrix& mass);

  /// Factorises K alone, for static solutions; false where it is not positive definite. factor() is its factor then.
  bool factorise_stiffness(const SparseMatrix& stiffness);

  /// The factor that the last solve() or factorise() made, of K - shift M.
  DefiniteFactor& factor();

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

/// Sum of |phi_i| |A_ij| |phi_j| over all entries, what rounding of phi' A phi is a part of [mode].
///
/// @param lower   of a symmetric matrix
/// @param shapes  [dof x mode]
Eigen::VectorXd sums_of_terms(const SparseMatrix& lower, const Eigen::Ref<const Eigen::MatrixXd>& shapes);

/// y = A x for a symmetric matrix given by its lower triangle, x of any number of columns.
Eigen::MatrixXd symmetric_product(const SparseMatrix& lower, const Eigen::Ref<const Eigen::MatrixXd>& x);

}  // namespace mottle::linalg
