#include "linalg/sparse/node_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "mottle/core/random.hpp"

namespace mottle::linalg {
namespace {

/// A square grid of nodes of three equations each, every node coupled with the eight around it; `missing` is the
/// fraction of the entries that is zero by chance and left out. Diagonally dominant.
SparseMatrix grid_of_nodes(int side, double missing) {
  RandomStream stream({.seed = 1}, 0);
  std::vector<Eigen::Triplet<double>> entries;
  for (int node = 0; node < side * side; ++node) {
    for (const auto& [right, down] : {std::pair{0, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
      const int x = node % side + right;
      const int y = node / side + down;
      if (x < 0 || x >= side || y >= side) continue;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const int row = 3 * (y * side + x) + i;
          const int column = 3 * node + j;
          if (row < column || (row != column && stream.uniform() < missing)) continue;
          entries.emplace_back(row, column, row == column ? 50.0 : 2.0 * stream.uniform() - 1.0);
        }
      }
    }
  }
  SparseMatrix lower(3 * side * side, 3 * side * side);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

SparseMatrix band(int order, int width) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < order; ++j) {
    for (int i = j; i < std::min(order, j + width + 1); ++i) entries.emplace_back(i, j, i == j ? 4.0 * width : -1.0);
  }
  SparseMatrix lower(order, order);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

TEST(NodeOrder, BlocksAreTheNodesWhereATenthOfTheEntriesIsMissing) {
  const std::vector<int> blocks = blocks_of_like_rows(grid_of_nodes(40, 0.1));
  int wrong = 0;
  for (int row = 0; row + 1 < 4800; ++row) {
    const bool is_same_node = row / 3 == (row + 1) / 3;
    const auto at = static_cast<std::size_t>(row);
    wrong += (blocks[at] == blocks[at + 1]) == is_same_node ? 0 : 1;
  }
  EXPECT_LT(wrong, 96);  // of a fiftieth of the rows chance makes the patterns less alike
}

TEST(NodeOrder, RowsOfABandAreNoNode) {
  EXPECT_EQ(blocks_of_like_rows(band(50, 1)).back(), 47);  // but for the two at each end
  const std::vector<int> blocks = blocks_of_like_rows(band(5000, 40));
  EXPECT_GT(blocks.back(), 5000 / 30);  // like the first of the block, not the one before: else it is one block
}

TEST(NodeOrder, FillsAsLittleAsTheOrderOfThePatternWithoutMissingEntries) {
  const SparseMatrix lower = grid_of_nodes(40, 0.1);
  const std::vector<int> order = order_by_nodes(lower);
  std::vector<int> rows = order;
  std::sort(rows.begin(), rows.end());
  std::vector<int> all(4800);
  std::iota(all.begin(), all.end(), 0);
  ASSERT_EQ(rows, all);
  const auto whole = make_definite_factor();
  ASSERT_TRUE(whole->factorise(grid_of_nodes(40, 0.0)));
  const auto by_metis = make_definite_factor(whole->order());
  ASSERT_TRUE(by_metis->factorise(lower));
  const auto by_nodes = make_definite_factor(order);
  ASSERT_TRUE(by_nodes->factorise(lower));
  EXPECT_LT(by_nodes->factor_entries(), 1.05 * by_metis->factor_entries());
  const auto unasked = make_definite_factor();
  ASSERT_TRUE(unasked->factorise(lower));
  EXPECT_EQ(unasked->order(), by_nodes->order());
}

TEST(NodeOrder, SolvesWhatItOrdered) {
  const SparseMatrix lower = grid_of_nodes(40, 0.1);
  const auto factor = make_definite_factor();
  ASSERT_TRUE(factor->factorise(lower));
  const Eigen::MatrixXd wanted = Eigen::MatrixXd::Random(4800, 3);
  Eigen::MatrixXd found = lower.selfadjointView<Eigen::Lower>() * wanted;
  factor->solve(found);
  EXPECT_LT((found - wanted).cwiseAbs().maxCoeff(), 1e-12);  // the condition number is below 10
}

TEST(NodeOrder, IsLeftToMetisWhereRowsOfANodeHaveOnePattern) {
  EXPECT_TRUE(order_by_nodes(grid_of_nodes(40, 0.0)).empty());
  EXPECT_TRUE(order_by_nodes(band(4000, 1)).empty());
  EXPECT_TRUE(order_by_nodes(SparseMatrix(0, 0)).empty());
}

}  // namespace
}  // namespace mottle::linalg
