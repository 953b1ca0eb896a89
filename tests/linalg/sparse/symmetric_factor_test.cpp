#include "mottle/linalg/sparse/symmetric_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <string>
#include <vector>

#include "linalg/batched/simd_kernels.hpp"
#include "linalg/pencils.hpp"
#include "mottle/core/random.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"

namespace mottle::linalg {
namespace {

using linalg_test::lower_of;

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  RandomStream stream({.seed = seed}, 0);
  Eigen::MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = 2.0 * stream.uniform() - 1.0;
  return matrix;
}

/// Springs of 1 between neighbours in a square grid and of 1 from each point to the ground.
Eigen::MatrixXd grid_laplacian(int side) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(side * side, side * side);
  const auto join = [&matrix](int a, int b) {
    matrix(a, a) += 1.0;
    matrix(b, b) += 1.0;
    matrix(a, b) = matrix(b, a) = -1.0;
  };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j + 1 < side; ++j) {
      join(i * side + j, i * side + j + 1);
      join(j * side + i, (j + 1) * side + i);
    }
  }
  return matrix;
}

/// About a third of the entries nonzero; the diagonal dominates.
Eigen::MatrixXd sparse_definite(int order) {
  Eigen::MatrixXd matrix = random_matrix(order, order, static_cast<unsigned>(order));
  matrix = matrix.unaryExpr([](double x) { return std::abs(x) < 0.8 ? 0.0 : x; });
  matrix = (matrix + matrix.transpose()).eval();
  matrix.diagonal() = matrix.cwiseAbs().rowwise().sum().array() + 0.5;
  return matrix;
}

/// Every row meets the first one and itself only.
Eigen::MatrixXd arrow(int order) {
  Eigen::MatrixXd matrix = 2.0 * Eigen::MatrixXd::Identity(order, order);
  matrix.row(0).setConstant(-1.0);
  matrix.col(0).setConstant(-1.0);
  matrix(0, 0) = order;
  return matrix;
}

/// Full blocks of 1, 2, ..., that do not meet.
Eigen::MatrixXd block_diagonal(int blocks) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(blocks * (blocks + 1) / 2, blocks * (blocks + 1) / 2);
  for (int size = 1, first = 0; size <= blocks; first += size++) matrix.block(first, first, size, size).array() += 1.0;
  return matrix;
}

struct Case {
  std::string name;
  Eigen::MatrixXd matrix;
};

std::vector<Case> all_cases() {
  const Eigen::MatrixXd dense = random_matrix(150, 150, 5);
  std::vector<Case> cases = {{"grid of 17 x 17", grid_laplacian(17)},
                             {"arrow of 40", arrow(40)},
                             {"blocks of 1 to 12", block_diagonal(12)},
                             {"dense of 150", dense * dense.transpose() + 10.0 * Eigen::MatrixXd::Identity(150, 150)}};
  for (int order = 1; order <= 60; ++order) {
    cases.push_back({"sparse of " + std::to_string(order), sparse_definite(order)});
  }
  return cases;
}

TEST(DefiniteFactor, SolvesLikeTheDenseInverse) {
  for (const auto& [name, matrix] : all_cases()) {
    const Eigen::MatrixXd inverse = matrix.inverse();
    const auto factor = make_definite_factor();
    ASSERT_TRUE(factor->factorise(lower_of(matrix))) << name;
    for (const int sides : {1, 3, 8, 17, 33, 70}) {
      const Eigen::MatrixXd right_hand_sides = random_matrix(matrix.rows(), sides, 1);
      Eigen::MatrixXd solution = right_hand_sides;
      factor->solve(solution);
      // Condition numbers of at most 1e4, times the rounding of a product of a row.
      EXPECT_LT((solution - inverse * right_hand_sides).cwiseAbs().maxCoeff(), 1e-12) << name << ", " << sides;
    }
  }
}

TEST(DefiniteFactor, RootTimesItsTransposeIsTheInverse) {
  for (const auto& [name, matrix] : all_cases()) {
    const auto factor = make_definite_factor();
    ASSERT_TRUE(factor->factorise(lower_of(matrix))) << name;
    VectorRows root = VectorRows::Identity(matrix.rows(), matrix.rows());
    factor->solve_root(root);
    EXPECT_LT((root * root.transpose() - matrix.inverse()).cwiseAbs().maxCoeff(), 1e-12) << name;
  }
}

TEST(DefiniteFactor, RightHandSidesDoNotFeelTheirNeighbours) {
  for (const auto& [name, matrix] : all_cases()) {
    const auto factor = make_definite_factor();
    ASSERT_TRUE(factor->factorise(lower_of(matrix))) << name;
    const Eigen::MatrixXd right_hand_sides = random_matrix(matrix.rows(), 41, 2);
    Eigen::MatrixXd solutions = right_hand_sides;
    VectorRows roots = right_hand_sides;
    factor->solve(solutions);
    factor->solve_root(roots);
    for (const int sides : {1, 2, 5, 8, 19}) {
      for (const int first : {0, 3, 22}) {
        Eigen::MatrixXd some = right_hand_sides.middleCols(first, sides);
        factor->solve(some);
        EXPECT_EQ(some, solutions.middleCols(first, sides)) << name << ", " << sides << " from " << first;
        VectorRows rows = right_hand_sides.middleCols(first, sides);
        factor->solve_rows(rows);
        EXPECT_EQ(rows, solutions.middleCols(first, sides)) << name << ", " << sides << " from " << first;
        rows = right_hand_sides.middleCols(first, sides);
        factor->solve_root(rows);
        EXPECT_EQ(rows, roots.middleCols(first, sides)) << name << ", " << sides << " from " << first;
      }
    }
  }
}

TEST(DefiniteFactor, ANeighbourThatIsNotANumberStaysAlone) {
  const auto factor = make_definite_factor();
  ASSERT_TRUE(factor->factorise(lower_of(grid_laplacian(17))));
  const Eigen::MatrixXd right_hand_sides = random_matrix(289, 8, 3);
  Eigen::MatrixXd solutions = right_hand_sides;
  factor->solve(solutions);
  Eigen::MatrixXd spoilt = right_hand_sides;
  spoilt.col(4).setConstant(std::nan(""));
  factor->solve(spoilt);
  EXPECT_EQ(spoilt.leftCols(4), solutions.leftCols(4));
  EXPECT_EQ(spoilt.rightCols(3), solutions.rightCols(3));
}

TEST(DefiniteFactor, SolvesWithTheLatestMatrixOfThePattern) {
  const Eigen::MatrixXd matrix = grid_laplacian(9);
  const auto factor = make_definite_factor();
  const Eigen::MatrixXd right_hand_sides = random_matrix(81, 3, 4);
  for (const double scale : {1.0, 4.0}) {
    ASSERT_TRUE(factor->factorise(lower_of(scale * matrix)));
    Eigen::MatrixXd solution = right_hand_sides;
    factor->solve(solution);
    EXPECT_LT((scale * matrix * solution - right_hand_sides).cwiseAbs().maxCoeff(), 1e-13) << scale;
  }
}

TEST(DefiniteFactor, SolvesInPartOfAMatrixAndLeavesTheRest) {
  const auto factor = make_definite_factor();
  ASSERT_TRUE(factor->factorise(lower_of(grid_laplacian(4))));
  Eigen::MatrixXd whole = random_matrix(20, 5, 6);
  const Eigen::MatrixXd before = whole;
  Eigen::MatrixXd part = whole.block(2, 1, 16, 3);
  factor->solve(part);
  factor->solve(whole.block(2, 1, 16, 3));
  EXPECT_EQ(whole.block(2, 1, 16, 3), part);
  whole.block(2, 1, 16, 3) = before.block(2, 1, 16, 3);
  EXPECT_EQ(whole, before);
}

TEST(DefiniteFactor, NothingIsSolvedForNothing) {
  const auto factor = make_definite_factor();
  ASSERT_TRUE(factor->factorise(lower_of(grid_laplacian(4))));
  Eigen::MatrixXd no_sides(16, 0);
  factor->solve(no_sides);
  VectorRows no_side_rows(16, 0);
  factor->solve_rows(no_side_rows);
  factor->solve_root(no_side_rows);
  EXPECT_EQ(no_sides.rows(), 16);
  const auto empty_factor = make_definite_factor();
  SparseMatrix empty(0, 0);
  ASSERT_TRUE(empty_factor->factorise(empty));
  Eigen::MatrixXd no_rows(0, 3);
  empty_factor->solve(no_rows);
  VectorRows no_rows_at_all(0, 3);
  empty_factor->solve_rows(no_rows_at_all);
  empty_factor->solve_root(no_rows_at_all);
  EXPECT_EQ(no_rows.cols(), 3);
}

/// L with supernodes of 1 to 19 columns, each followed by a third of the later rows; nan above the diagonals.
struct MadeLower {
  std::vector<int> columns = {0};
  std::vector<int> row_starts = {0};
  std::vector<int> rows = {};
  std::vector<int> value_starts = {0};
  std::vector<double> values = {};
  Eigen::MatrixXd dense;

  explicit MadeLower(const std::vector<int>& widths) {
    for (const int width : widths) columns.push_back(columns.back() + width);
    dense = Eigen::MatrixXd::Zero(columns.back(), columns.back());
    const Eigen::MatrixXd entries = random_matrix(dense.rows(), dense.cols(), 7);
    for (std::size_t s = 0; s < widths.size(); ++s) append(columns[s], columns[s + 1], entries);
  }

  void append(int first, int last, const Eigen::MatrixXd& entries) {
    const auto begin = static_cast<std::ptrdiff_t>(rows.size());
    for (int row = first; row < columns.back(); ++row) {
      if (row < last || row % 3 == first % 3) rows.push_back(row);
    }
    for (int column = first; column < last; ++column) {
      for (auto row = rows.begin() + begin; row != rows.end(); ++row) {
        const double value = *row == column ? 3.0 : 0.2 * entries(*row, column);
        values.push_back(*row < column ? std::nan("") : value);
        if (*row >= column) dense(*row, column) = value;
      }
    }
    row_starts.push_back(static_cast<int>(rows.size()));
    value_starts.push_back(static_cast<int>(values.size()));
  }

  simd_kernels::SupernodalLower view() const {
    return {static_cast<int>(columns.size()) - 1,
            columns.data(),
            row_starts.data(),
            rows.data(),
            value_starts.data(),
            values.data()};
  }
};

void expect_solutions(const simd_kernels::Kernels& kernels) {
  const MadeLower lower({5, 1, 8, 2, 16, 3, 19, 4, 7, 6, 9});
  const auto triangle = lower.dense.triangularView<Eigen::Lower>();
  for (const int width : {1, 8, 24}) {
    const VectorRows sides = random_matrix(lower.dense.rows(), width, 8);
    VectorRows x = sides;
    kernels.solve_lower(lower.view(), width, x.data());
    // The condition number is below 1e3.
    EXPECT_LT((x - triangle.solve(sides)).cwiseAbs().maxCoeff(), 1e-13) << width;
    x = sides;
    kernels.solve_lower_transposed(lower.view(), width, x.data());
    EXPECT_LT((x - triangle.transpose().solve(sides)).cwiseAbs().maxCoeff(), 1e-13) << width;
    VectorRows alone = sides.col(width / 2);
    kernels.solve_lower_transposed(lower.view(), 1, alone.data());
    EXPECT_EQ(alone, x.col(width / 2)) << width;
  }
}

TEST(SupernodalKernels, SolveInRegistersOfEveryWidth) {
  expect_solutions(simd_kernels::k_plain);
#if defined(__x86_64__)
  if (is_simd_level_available(SimdLevel::avx2)) expect_solutions(simd_kernels::k_avx2);
  if (is_simd_level_available(SimdLevel::avx512)) expect_solutions(simd_kernels::k_avx512);
#endif
}

}  // namespace
}  // namespace mottle::linalg
