#include "mottle/linalg/dense/products.hpp"

#include <gtest/gtest.h>

namespace mottle::linalg {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Products, AgreeWithEigenAndWithEachColumnAloneWhenSmallAndTransposed) {
  const MatrixXd a = MatrixXd::Random(83, 15), b = MatrixXd::Random(83, 11);
  const VectorRows found = transposed_product_by_rows(a, to_rows(b));
  EXPECT_LT((found.leftCols(11) - a.transpose() * b).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_EQ(found.rightCols(found.cols() - 11).cwiseAbs().maxCoeff(), 0.0);
  for (Eigen::Index c = 0; c < a.cols(); ++c) {
    EXPECT_EQ(transposed_product_by_rows(a.col(c), to_rows(b)), found.row(c)) << c;
  }
}

TEST(Products, NearlyDiagonalIsRelativeToBothDiagonalEntries) {
  MatrixXd matrix = VectorXd::LinSpaced(4, 1.0, 1e-8).asDiagonal();
  matrix(3, 3) = 1e-8;
  EXPECT_TRUE(is_nearly_diagonal(matrix));
  matrix(3, 0) = 1e-16;
  EXPECT_TRUE(is_nearly_diagonal(matrix));
  matrix(3, 0) = 1e-14;
  EXPECT_FALSE(is_nearly_diagonal(matrix));
  matrix(3, 0) = 0.0;
  matrix(3, 3) = 0.0;
  EXPECT_TRUE(is_nearly_diagonal(matrix));
}

}  // namespace
}  // namespace mottle::linalg
