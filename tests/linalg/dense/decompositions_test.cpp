// Each decomposition is held against the equation that defines it.
#include "mottle/linalg/dense/decompositions.hpp"

#include <gtest/gtest.h>

namespace mottle::linalg {
namespace {

constexpr double k_rounding = 1e-13;  // some tens of units in the last place of numbers near 1

/// Entries that follow no pattern, between -1 and 1.
Eigen::MatrixXd some_matrix(Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto k = static_cast<double>(i + 11 * j);
      matrix(i, j) = std::sin(1.0 + 7.3 * k + 0.61 * k * k);
    }
  }
  return matrix;
}

Eigen::MatrixXd some_covariance(Eigen::Index size) {
  const Eigen::MatrixXd root = some_matrix(size, size + 3);
  return root * root.transpose();
}

TEST(SymmetricEigen, GivesTheMatrixBackFromItsLowerTriangle) {
  const Eigen::MatrixXd matrix = some_covariance(6);
  Eigen::MatrixXd lower = matrix;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(1e9);
  const SymmetricEigen eigen(lower);
  EXPECT_TRUE(eigen.has_converged());
  const Eigen::MatrixXd again =
      eigen.eigenvectors() * eigen.eigenvalues().asDiagonal() * eigen.eigenvectors().transpose();
  EXPECT_LT((again - matrix).norm(), k_rounding * matrix.norm());
  EXPECT_LT((symmetric_eigenvalues(matrix) - eigen.eigenvalues()).norm(), k_rounding * matrix.norm());
}

TEST(SymmetricEigen, GivesTheClosedFormOfAChain) {
  // Eigenvalues of the second difference with fixed ends: 2 - 2 cos(k pi / (n + 1)).
  constexpr int n = 7;
  const SymmetricEigen eigen(Eigen::VectorXd::Constant(n, 2.0), Eigen::VectorXd::Constant(n - 1, -1.0));
  for (int k = 1; k <= n; ++k) {
    EXPECT_NEAR(eigen.eigenvalues()(k - 1), 2.0 - 2.0 * std::cos(k * M_PI / (n + 1)), k_rounding);
  }
}

TEST(CholeskyFactor, SolvesWithOneColumnAndWithMany) {
  const Eigen::MatrixXd matrix = some_covariance(5);
  const CholeskyFactor factor(matrix);
  ASSERT_TRUE(factor.is_positive_definite());
  EXPECT_LT((factor.lower() * factor.lower().transpose() - matrix).norm(), k_rounding * matrix.norm());
  const Eigen::MatrixXd right = some_matrix(5, 3);
  constexpr double k_conditioned = 1e-10;  // rounding times the condition number of this matrix
  EXPECT_LT((matrix * factor.solve(right) - right).norm(), k_conditioned);
  EXPECT_LT((matrix * factor.solve(right.col(1)) - right.col(1)).norm(), k_conditioned);
  EXPECT_LT((factor.lower() * factor.solve_lower(right) - right).norm(), k_conditioned);
  Eigen::MatrixXd upper = right;
  factor.solve_upper_in_place(upper);
  EXPECT_LT((factor.lower().transpose() * upper - right).norm(), k_conditioned);
  EXPECT_NEAR(factor.log_determinant(), symmetric_eigenvalues(matrix).array().log().sum(), k_conditioned);
}

TEST(CholeskyFactor, SaysThatAMatrixIsNotPositiveDefinite) {
  EXPECT_FALSE(CholeskyFactor(-Eigen::MatrixXd::Identity(2, 2)).is_positive_definite());
}

TEST(SolveSemidefinite, LeavesOutADirectionWithoutStiffness) {
  const Eigen::MatrixXd root = some_matrix(4, 2);
  const Eigen::MatrixXd matrix = root * root.transpose();  // of rank 2
  const Eigen::VectorXd right = matrix * Eigen::VectorXd::Ones(4);
  EXPECT_LT((matrix * solve_semidefinite(matrix, right) - right).norm(), 1e-12);
  EXPECT_EQ((semidefinite_pivots(matrix).array().abs() > 1e-12).count(), 2);
}

TEST(InverseByLu, TimesTheMatrixIsOne) {
  const Eigen::MatrixXd matrix = some_matrix(5, 5) + 3.0 * Eigen::MatrixXd::Identity(5, 5);
  EXPECT_LT((inverse_by_lu(matrix) * matrix - Eigen::MatrixXd::Identity(5, 5)).norm(), k_rounding);
}

TEST(PivotedQr, SpansWhatTheColumnsSpan) {
  Eigen::MatrixXd matrix = some_matrix(6, 3);
  matrix.col(2) = matrix.col(0) - 2.0 * matrix.col(1);
  const PivotedQr factor(matrix, 1e-10);
  ASSERT_EQ(factor.rank(), 2);
  const Eigen::MatrixXd range = factor.range();
  EXPECT_LT((range.transpose() * range - Eigen::MatrixXd::Identity(2, 2)).norm(), k_rounding);
  EXPECT_LT((range * (range.transpose() * matrix) - matrix).norm(), k_rounding * matrix.norm());
  EXPECT_LT(std::abs(factor.diagonal()(2)), k_rounding * std::abs(factor.diagonal()(0)));
}

TEST(PivotedQr, InvertsASquareMatrix) {
  const Eigen::MatrixXd matrix = some_matrix(4, 4) + 2.0 * Eigen::MatrixXd::Identity(4, 4);
  EXPECT_LT((PivotedQr(matrix).inverse() * matrix - Eigen::MatrixXd::Identity(4, 4)).norm(), k_rounding);
}

TEST(PivotedQr, LeavesResidualsAtRightAnglesToTheColumns) {
  const Eigen::MatrixXd matrix = some_matrix(6, 2);
  const Eigen::MatrixXd right = some_matrix(6, 3).array() + 0.5;
  const Eigen::MatrixXd residual = right - matrix * PivotedQr(matrix).solve(right);
  EXPECT_GT(residual.norm(), 0.1);
  EXPECT_LT((matrix.transpose() * residual).norm(), k_rounding * right.norm() * matrix.norm());
}

TEST(PivotedQr, TakesTheLongestColumnFirst) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3, 3);
  matrix(1, 1) = 5.0;
  EXPECT_EQ(PivotedQr(matrix).column(0), 1);
}

TEST(OrthonormalColumns, SpanTheColumns) {
  const Eigen::MatrixXd matrix = some_matrix(7, 3);
  const Eigen::MatrixXd q = orthonormal_columns(matrix);
  EXPECT_LT((q.transpose() * q - Eigen::MatrixXd::Identity(3, 3)).norm(), k_rounding);
  EXPECT_LT((q * (q.transpose() * matrix) - matrix).norm(), k_rounding * matrix.norm());
}

TEST(LeastNormSolver, IsTheMoorePenroseInverse) {
  Eigen::MatrixXd matrix = some_matrix(5, 4);
  matrix.col(3) = matrix.col(0) + matrix.col(1);
  const LeastNormSolver solver(matrix, 1e-10);
  const Eigen::MatrixXd inverse = solver.pseudo_inverse();
  EXPECT_LT((matrix * inverse * matrix - matrix).norm(), 1e-12);
  EXPECT_LT((inverse * matrix * inverse - inverse).norm(), 1e-12);
  EXPECT_LT((matrix * inverse - (matrix * inverse).transpose()).norm(), 1e-12);
  EXPECT_LT((inverse * matrix - (inverse * matrix).transpose()).norm(), 1e-12);
  const Eigen::VectorXd right = some_matrix(5, 1);
  EXPECT_LT((solver.solve(right) - inverse * right).norm(), 1e-12);
}

TEST(SingularValues, GiveTheMatrixBack) {
  const Eigen::MatrixXd matrix = some_matrix(5, 3);
  const SingularValues svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  EXPECT_LT((svd.left() * svd.values().asDiagonal() * svd.right().transpose() - matrix).norm(), k_rounding);
  EXPECT_EQ(svd.rank(), 3);
  EXPECT_EQ(SingularValues(matrix).left().size(), 0);
}

/// Variances of 1e18 and 1e-8, correlation 0.6: the inverse is that of the correlations, in units.
TEST(SemidefinitePseudoInverse, DoesNotDependOnUnits) {
  const Eigen::Vector2d size(1e9, 1e-4);
  Eigen::Matrix2d correlation;
  correlation << 1.0, 0.6, 0.6, 1.0;
  const Eigen::MatrixXd inverse = semidefinite_pseudo_inverse(size.asDiagonal() * correlation * size.asDiagonal());
  const Eigen::Matrix2d expected = correlation.inverse();
  EXPECT_LT((size.asDiagonal() * inverse * size.asDiagonal() - expected).norm(), 1e-12);
}

/// Of two parameters that always move together, and one without scatter.
TEST(SemidefinitePseudoInverse, LeavesOutDirectionsWithoutScatter) {
  const Eigen::Vector3d size(1e9, 1e-4, 0.0);
  Eigen::Matrix3d covariance = size * size.transpose();
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 3);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) expected(i, j) = 0.25 / (size(i) * size(j));
  }
  const Eigen::MatrixXd inverse = semidefinite_pseudo_inverse(covariance);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(inverse(i, j), expected(i, j), 1e-9 * std::abs(expected(i, j)));
  }
}

}  // namespace
}  // namespace mottle::linalg
