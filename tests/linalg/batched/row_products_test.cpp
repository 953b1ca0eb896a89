// Products of vectors that lie row by row, in registers of every width, against dense matrices.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "linalg/batched/simd_kernels.hpp"
#include "linalg/pencils.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg_test::every_level;
using linalg_test::level_name;
using linalg_test::lower_of;

MatrixXd random_matrix(Index rows, Index columns, std::mt19937_64& random) {
  std::uniform_real_distribution<double> distribution(-1.0, 1.0);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return distribution(random); });
}

/// Ascending, with gaps.
std::vector<int> some_rows(int count) {
  std::vector<int> rows;
  for (int i = 0; i < count; ++i) rows.push_back(i + i / 3);
  return rows;
}

class RowProducts : public linalg_test::AtEveryLevel {
 protected:
  std::mt19937_64 random_{1};
};
INSTANTIATE_TEST_SUITE_P(Levels, RowProducts, every_level(), level_name);

TEST_P(RowProducts, ASymmetricMatrixWorksOnItsOwnRowsOfLongerVectors) {
  constexpr int k_order = 40, k_total = 90;
  const simd_kernels::Kernels& kernels = simd_kernels::kernels_for(GetParam());
  MatrixXd dense = random_matrix(k_order, k_order, random_);
  dense = (dense + dense.transpose()).eval();
  for (double& entry : dense.reshaped()) entry = std::abs(entry) < 0.7 ? 0.0 : entry;
  const SparseMatrix lower = lower_of(dense);
  const std::vector<int> row_indices = some_rows(k_order);
  const simd_kernels::SparseLower view{k_order, lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr(),
                                       row_indices.data()};
  for (const int width : {8, 16, 24, 40, 64, 72}) {
    const VectorRows whole = random_matrix(k_total, width, random_);
    const MatrixXd own = whole(row_indices, Eigen::all);
    const VectorRows own_rows = own;
    const MatrixXd product = dense * own;

    VectorRows result = VectorRows::Ones(k_order, width);
    kernels.add_symmetric_product(view, width, own_rows.data(), result.data());
    EXPECT_LT((result - VectorRows::Ones(k_order, width) - product).cwiseAbs().maxCoeff(), 1e-13) << width;

    result.setOnes();
    VectorRows rest = VectorRows::Zero(k_order, width);
    kernels.add_local_product(view, width, whole.data(), result.data(), rest.data());
    EXPECT_LT((result - VectorRows::Ones(k_order, width) - product).cwiseAbs().maxCoeff(), 1e-13) << width;

    const VectorXd scales = random_matrix(width, 1, random_);
    VectorRows spread = VectorRows::Ones(k_total, width);
    MatrixXd expected = spread;
    expected(row_indices, Eigen::all) += product * scales.asDiagonal();
    kernels.add_scaled_product(view, scales.data(), width, whole.data(), spread.data());
    EXPECT_LT((spread - expected).cwiseAbs().maxCoeff(), 1e-13) << width;
  }
}

TEST_P(RowProducts, TermsThatCancelLeaveTheirDigits) {
  // A chain of stiff springs moved almost as a rigid body: forces are 10^-10 of the terms that make them.
  constexpr int k_order = 50, k_width = 8;
  MatrixXd dense = MatrixXd::Zero(k_order, k_order);
  for (int i = 0; i + 1 < k_order; ++i) {
    const double stiffness = std::ldexp(1.0 + 0.01 * i, 40);
    dense(i, i) += stiffness;
    dense(i + 1, i + 1) += stiffness;
    dense(i + 1, i) = dense(i, i + 1) = -stiffness;
  }
  const SparseMatrix lower = lower_of(dense);
  std::vector<int> row_indices(k_order);
  std::iota(row_indices.begin(), row_indices.end(), 0);
  const VectorRows motion = VectorRows::Ones(k_order, k_width) / 3.0 + 1e-10 * random_matrix(k_order, k_width, random_);
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Long exact = dense.cast<long double>() * motion.cast<long double>();
  VectorRows result = VectorRows::Zero(k_order, k_width), rest = result;
  simd_kernels::kernels_for(GetParam())
      .add_local_product({k_order, lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr(), row_indices.data()},
                         k_width, motion.data(), result.data(), rest.data());
  const Long error = (result + rest).cast<long double>() - exact;
  EXPECT_LT(static_cast<double>(error.cwiseAbs().maxCoeff()), 1e-8 * exact.cwiseAbs().maxCoeff());  // of the reference
}

TEST_P(RowProducts, GatheredVectorsLieByColumnsOrByRows) {
  constexpr int k_total = 700;
  const simd_kernels::Kernels& kernels = simd_kernels::kernels_for(GetParam());
  for (const int row_count : {1, 127, 128, 129, 400}) {
    const std::vector<int> rows = some_rows(row_count);
    for (const int vectors : {1, 3, 4, 9, 64}) {
      const MatrixXd columns = random_matrix(k_total, vectors, random_);
      const VectorRows by_rows = columns;
      for (const int width : {8, 16, 40, 48, 56, 104}) {
        const VectorRows right = random_matrix(row_count, width, random_);
        const auto difference = [&](const double* data, long row_step, long vector_step, const int* own_rows) {
          const MatrixXd left = own_rows == nullptr ? MatrixXd(columns.topRows(row_count)) : columns(rows, Eigen::all);
          VectorRows result = VectorRows::Ones(vectors, width);
          kernels.add_gathered_product({vectors, data, row_step, vector_step, row_count, own_rows}, width, right.data(),
                                       result.data());
          return (result - VectorRows::Ones(vectors, width) - left.transpose() * right).cwiseAbs().maxCoeff();
        };
        SCOPED_TRACE(testing::Message() << row_count << " rows, " << vectors << " and " << width << " vectors");
        EXPECT_LT(difference(columns.data(), 1, k_total, rows.data()), 1e-12);
        EXPECT_LT(difference(by_rows.data(), vectors, 1, rows.data()), 1e-12);
        EXPECT_LT(difference(by_rows.data(), vectors, 1, nullptr), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace mottle::linalg
