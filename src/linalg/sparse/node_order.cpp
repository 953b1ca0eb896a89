#include "linalg/sparse/node_order.hpp"

#include <suitesparse/cholmod.h>

#include <algorithm>
#include <cstddef>
#include <span>

#include "linalg/sparse/one_order.hpp"

namespace mottle::linalg {
namespace {

/// Of each row the columns with entries in the whole matrix, ascending.
class WholePattern {
 public:
  explicit WholePattern(const SparseMatrix& lower) : starts_(static_cast<std::size_t>(lower.rows()) + 1, 0) {
    const auto entries = [&](const auto& visit) {
      for (int j = 0; j < lower.outerSize(); ++j) {
        for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) visit(static_cast<int>(entry.row()), j);
      }
    };
    entries([&](int i, int j) {
      ++starts_[static_cast<std::size_t>(i) + 1];
      if (i != j) ++starts_[static_cast<std::size_t>(j) + 1];
    });
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    columns_.resize(static_cast<std::size_t>(starts_.back()));
    std::vector<int> next(starts_.begin(), starts_.end() - 1);
    const auto add = [&](int i, int j) { columns_[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = j; };
    entries([&](int i, int j) {  // left of the diagonal, by ascending columns
      if (i != j) add(i, j);
    });
    entries([&](int i, int j) { add(j, i); });
  }

  std::span<const int> row(int i) const {
    const int* const from = columns_.data();
    return {from + starts_[static_cast<std::size_t>(i)], from + starts_[static_cast<std::size_t>(i) + 1]};
  }

 private:
  std::vector<int> starts_, columns_;
};

bool are_alike(std::span<const int> one, std::span<const int> other) {
  std::size_t both = 0;
  for (auto a = one.begin(), b = other.begin(); a != one.end() && b != other.end();) {
    both += *a == *b ? 1 : 0;
    const bool is_a_next = *a <= *b;
    const bool is_b_next = *b <= *a;
    a += is_a_next ? 1 : 0;
    b += is_b_next ? 1 : 0;
  }
  const std::size_t either = one.size() + other.size() - both;
  return 8 * both > 5 * either;
}

/// Rows in a block of exactly one pattern, which METIS puts together itself: their mean number. By the lower triangle
/// alone, which is enough to know whether it is about one or about that of a node's equations.
double mean_rows_of_one_pattern(const SparseMatrix& lower) {
  int blocks = 1;
  const auto rows_of = [&](int j) {
    const int* const rows = lower.innerIndexPtr();
    return std::span<const int>(rows + lower.outerIndexPtr()[j], rows + lower.outerIndexPtr()[j + 1]);
  };
  for (int j = 0; j + 1 < lower.outerSize(); ++j) {
    const std::span<const int> one = rows_of(j);
    blocks += !one.empty() && std::ranges::equal(one.subspan(1), rows_of(j + 1)) ? 0 : 1;
  }
  return static_cast<double>(lower.rows()) / blocks;
}

/// The lower triangle of the blocks' graph, as CHOLMOD takes it.
struct BlockGraph {
  std::vector<int> starts, rows;

  BlockGraph(const SparseMatrix& lower, const std::vector<int>& blocks) {
    std::vector<int> seen_from(static_cast<std::size_t>(blocks.back()) + 1, -1);
    for (int j = 0; j < lower.outerSize(); ++j) {
      const int column = blocks[static_cast<std::size_t>(j)];
      if (column == static_cast<int>(starts.size())) starts.push_back(static_cast<int>(rows.size()));
      for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
        const int row = blocks[static_cast<std::size_t>(entry.row())];
        int& seen = seen_from[static_cast<std::size_t>(row)];
        if (seen != column) rows.push_back(row);
        seen = column;
      }
    }
    starts.push_back(static_cast<int>(rows.size()));
  }

  cholmod_sparse view() {
    cholmod_sparse sparse = {};
    sparse.nrow = sparse.ncol = starts.size() - 1;
    sparse.nzmax = rows.size();
    sparse.p = starts.data();
    sparse.i = rows.data();
    sparse.stype = -1;
    sparse.itype = CHOLMOD_INT;
    sparse.xtype = CHOLMOD_PATTERN;
    sparse.packed = 1;
    return sparse;
  }
};

/// By METIS; empty where it has not enough memory.
std::vector<int> dissect(BlockGraph graph) {
  cholmod_common common = {};
  cholmod_start(&common);
  common.print = 0;
  common.error_handler = nullptr;
  std::vector<int> order(graph.starts.size() - 1);
  cholmod_sparse view = graph.view();
  const bool is_found = cholmod_metis(&view, nullptr, 0, 1, order.data(), &common) != 0;
  cholmod_finish(&common);
  return is_found ? order : std::vector<int>();
}

}  // namespace

ProcessMutex& one_order_at_a_time() {
  static constinit ProcessMutex mutex;
  return mutex;
}

std::vector<int> blocks_of_like_rows(const SparseMatrix& lower) {
  const WholePattern pattern(lower);
  std::vector<int> blocks(static_cast<std::size_t>(lower.rows()), 0);
  int first = 0;
  for (int i = 1; i < lower.rows(); ++i) {
    const bool belongs = are_alike(pattern.row(first), pattern.row(i));
    blocks[static_cast<std::size_t>(i)] = blocks[static_cast<std::size_t>(i) - 1] + (belongs ? 0 : 1);
    if (!belongs) first = i;
  }
  return blocks;
}

std::vector<int> order_by_nodes(const SparseMatrix& lower) {
  constexpr double k_worthwhile = 1.5;  // times as many rows in a block as METIS puts together
  const double found_by_metis = mean_rows_of_one_pattern(lower);
  if (lower.rows() == 0 || found_by_metis > 2.5) return {};
  const std::vector<int> blocks = blocks_of_like_rows(lower);
  if (static_cast<double>(lower.rows()) / (blocks.back() + 1) < k_worthwhile * found_by_metis) return {};
  std::vector<int> firsts;  // rows at which blocks begin
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i] == static_cast<int>(firsts.size())) firsts.push_back(static_cast<int>(i));
  }
  firsts.push_back(static_cast<int>(blocks.size()));
  std::vector<int> order;
  for (const int block : dissect(BlockGraph(lower, blocks))) {
    const auto at = static_cast<std::size_t>(block);
    for (int row = firsts[at]; row < firsts[at + 1]; ++row) order.push_back(row);
  }
  return order;
}

}  // namespace mottle::linalg
