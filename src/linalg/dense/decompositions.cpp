#include "mottle/linalg/dense/decompositions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace mottle::linalg {
namespace {

template <typename Factor>
Factor factor_of(const Eigen::MatrixXd& matrix, std::optional<double> threshold) {
  Factor factor;
  if (threshold) factor.setThreshold(*threshold);
  factor.compute(matrix);
  return factor;
}

}  // namespace

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) {  // which the solver does not take
    eigenvectors_.resize(0, 0);
    has_converged_ = true;
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  eigenvalues_ = solver.eigenvalues();
  eigenvectors_ = solver.eigenvectors();
  has_converged_ = solver.info() == Eigen::Success;
}

SymmetricEigen::SymmetricEigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& subdiagonal) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, subdiagonal);
  eigenvalues_ = solver.eigenvalues();
  eigenvectors_ = solver.eigenvectors();
  has_converged_ = solver.info() == Eigen::Success;
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

CholeskyFactor::CholeskyFactor(const Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  factor_ = factor.matrixLLT();
  is_positive_definite_ = factor.info() == Eigen::Success;
}

void CholeskyFactor::solve_lower_in_place(Eigen::MatrixXd& columns) const {
  factor_.triangularView<Eigen::Lower>().solveInPlace(columns);
}

void CholeskyFactor::solve_lower_in_place(Eigen::VectorXd& column) const {
  factor_.triangularView<Eigen::Lower>().solveInPlace(column);
}

void CholeskyFactor::solve_upper_in_place(Eigen::MatrixXd& columns) const {
  factor_.adjoint().triangularView<Eigen::Upper>().solveInPlace(columns);
}

void CholeskyFactor::solve_in_place(Eigen::MatrixXd& columns) const {
  solve_lower_in_place(columns);
  solve_upper_in_place(columns);
}

void CholeskyFactor::solve_in_place(Eigen::VectorXd& column) const {
  solve_lower_in_place(column);
  factor_.adjoint().triangularView<Eigen::Upper>().solveInPlace(column);
}

void solve_semidefinite_in_place(const Eigen::MatrixXd& matrix, Eigen::MatrixXd& columns) {
  Eigen::LDLT<Eigen::MatrixXd>(matrix).solveInPlace(columns);
}

void solve_semidefinite_in_place(const Eigen::MatrixXd& matrix, Eigen::VectorXd& column) {
  Eigen::LDLT<Eigen::MatrixXd>(matrix).solveInPlace(column);
}

Eigen::VectorXd semidefinite_pivots(const Eigen::MatrixXd& matrix) {
  return Eigen::LDLT<Eigen::MatrixXd>(matrix).vectorD();
}

Eigen::MatrixXd semidefinite_pseudo_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::ArrayXd diagonal = matrix.diagonal();
  const Eigen::VectorXd scale = (diagonal > 0.0).select(diagonal.abs().rsqrt(), 1.0);
  const LeastNormSolver correlations(scale.asDiagonal() * matrix * scale.asDiagonal());
  return scale.asDiagonal() * correlations.pseudo_inverse() * scale.asDiagonal();
}

Eigen::MatrixXd inverse_by_lu(const Eigen::MatrixXd& matrix) {
  return matrix.inverse();
}

struct PivotedQr::Factor {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
};

PivotedQr::PivotedQr(const Eigen::MatrixXd& matrix, std::optional<double> threshold)
    : factor_(std::make_shared<const Factor>(
          Factor{factor_of<Eigen::ColPivHouseholderQR<Eigen::MatrixXd>>(matrix, threshold)})) {}

Eigen::Index PivotedQr::rank() const {
  return factor_->qr.rank();
}

Eigen::VectorXd PivotedQr::diagonal() const {
  return factor_->qr.matrixQR().diagonal();
}

Eigen::Index PivotedQr::column(Eigen::Index k) const {
  return factor_->qr.colsPermutation().indices()[k];
}

Eigen::MatrixXd PivotedQr::range() const {
  return factor_->qr.householderQ() * Eigen::MatrixXd::Identity(factor_->qr.rows(), rank());
}

Eigen::MatrixXd PivotedQr::solve(const Eigen::MatrixXd& right) const {
  return factor_->qr.solve(right);
}

Eigen::MatrixXd PivotedQr::inverse() const {
  return factor_->qr.inverse();
}

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> factor(matrix);
  return factor.householderQ() * Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
}

struct LeastNormSolver::Factor {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> orthogonal;
};

LeastNormSolver::LeastNormSolver(const Eigen::MatrixXd& matrix, std::optional<double> threshold)
    : factor_(std::make_shared<const Factor>(
          Factor{factor_of<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>>(matrix, threshold)})) {}

Eigen::VectorXd LeastNormSolver::solve(const Eigen::VectorXd& right) const {
  return factor_->orthogonal.solve(right);
}

Eigen::MatrixXd LeastNormSolver::pseudo_inverse() const {
  return factor_->orthogonal.pseudoInverse();
}

SingularValues::SingularValues(const Eigen::MatrixXd& matrix, unsigned vectors) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, vectors);
  values_ = svd.singularValues();
  if (svd.computeU()) left_ = svd.matrixU();
  if (svd.computeV()) right_ = svd.matrixV();
  rank_ = svd.rank();
}

}  // namespace mottle::linalg
