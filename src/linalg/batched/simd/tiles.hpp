// Symmetric matrices in square tiles, and blocks of vectors: sums of terms, products, Gram matrices. A block is
// [row][vector], its vectors a multiple of k_block_columns.
#pragma once

#include "linalg/batched/simd/term_sum.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// A block of vectors: `stride` of them in memory, the first `columns` at work.
struct Block {
  Simd* data;
  int rows;
  int stride;
  int columns;

  MOTTLE_INLINE Simd* row(int i) const { return data + static_cast<long>(i) * stride; }
};

MOTTLE_INLINE Simd in_all_lanes(double x) {
  return broadcast(x);
}
MOTTLE_INLINE Simd in_all_lanes(Simd x) {
  return x;
}

/// out_rc += sum_k a_rk b_kc, or = where it is new, for Rows rows and k_block_columns columns, held in registers.
///
/// @param a        of each lane, or doubles that are the same in all
/// @param a_row    from one row of a to the next; a_step from one k to the next
/// @param b_step   from one row of b to the next
template <int Rows, bool IsNew = false, typename Entry>
MOTTLE_INLINE void accumulate(const Entry* a, long a_row, long a_step, const Simd* b, long b_step, int count, Simd* out,
                              long out_row) {
  Simd sum[Rows][k_block_columns];
  for (int r = 0; r < Rows; ++r) {
    for (int c = 0; c < k_block_columns; ++c) sum[r][c] = IsNew ? broadcast(0.0) : out[r * out_row + c];
  }
  for (int k = 0; k < count; ++k, a += a_step, b += b_step) {
    for (int r = 0; r < Rows; ++r) {
      const Simd left = in_all_lanes(a[r * a_row]);
      for (int c = 0; c < k_block_columns; ++c) sum[r][c] += left * b[c];
    }
  }
  for (int r = 0; r < Rows; ++r) {
    for (int c = 0; c < k_block_columns; ++c) out[r * out_row + c] = sum[r][c];
  }
}

/// tile = constant + sum of coefficient * term; the terms' tiles lie one after another.
inline void combine_tile(const double* terms, int count, const Simd* coefficients, Simd* tile) {
  constexpr long k_entries = k_tile * k_tile;
  sum_terms(
      terms, k_entries, count, [=](int term) MOTTLE_FLAT { return coefficients[term]; }, k_entries, tile);
}

/// The entry (i, j), i >= j, of a matrix in tiles.
MOTTLE_INLINE Simd tile_entry(const Simd* matrix, int order, int i, int j) {
  const long tile = packed_index(order / k_tile, i / k_tile, j / k_tile);
  return matrix[tile * k_tile * k_tile + static_cast<long>(i % k_tile) * k_tile + j % k_tile];
}

/// out_I += tile in_J, or its transpose; = where it is new.
template <bool Transposed, bool IsNew = false, typename Entry>
MOTTLE_INLINE void multiply_tile(const Entry* tile, const Block& in, int in_row, const Block& out, int out_row) {
  constexpr long k_row = Transposed ? 1 : k_tile, k_step = Transposed ? k_tile : 1;
  for (int c = 0; c < in.columns; c += k_block_columns) {
    const Simd* const b = in.row(in_row) + c;
    for (int r = 0; r < k_tile; r += MOTTLE_TILE_ROWS) {
      accumulate<MOTTLE_TILE_ROWS, IsNew>(tile + r * k_row, k_row, k_step, b, in.stride, k_tile,
                                          out.row(out_row + r) + c, out.stride);
    }
  }
}

/// out += A in, or = where it is new, where only the rows [from, to) of `in`, multiples of k_tile, are not zero; they
/// begin at 0 where it is new.
template <bool IsNew = false>
inline void add_product(const Simd* matrix, const Block& in, int from, int to, const Block& out) {
  const int tiles = in.rows / k_tile;
  const auto holds = [=](int tile) MOTTLE_FLAT { return from <= tile * k_tile && tile * k_tile < to; };
  const Simd* tile = matrix;
  for (int j = 0; j < tiles; ++j) {
    for (int i = j; i < tiles; ++i, tile += k_tile * k_tile) {
      if (IsNew && j == 0) {
        multiply_tile<false, true>(tile, in, 0, out, i * k_tile);
      } else if (holds(j)) {
        multiply_tile<false>(tile, in, j * k_tile, out, i * k_tile);
      }
      if (i != j && holds(i)) multiply_tile<true>(tile, in, i * k_tile, out, j * k_tile);
    }
  }
}

/// out_i = or += tile in_j, j the tile's column.
template <typename Entry>
MOTTLE_INLINE void multiply_next(const Entry* tile, const Block& in, int j, const Block& out, int i) {
  if (j == 0) {
    multiply_tile<false, true>(tile, in, j, out, i);
  } else {
    multiply_tile<false>(tile, in, j, out, i);
  }
}

/// out = A in for a matrix that is needed once: each of its tiles is used as soon as it is summed.
inline void multiply_terms(const double* terms, int count, const Simd* coefficients, const Block& in, Simd* tile,
                           const Block& out) {
  for (int i = 0; i < out.rows; i += k_tile) {
    for (int j = 0; j < in.rows; j += k_tile, terms += (1 + count) * k_tile * k_tile) {
      if (count == 0) {
        multiply_next(terms, in, j, out, i);
      } else {
        combine_tile(terms, count, coefficients, tile);
        multiply_next(tile, in, j, out, i);
      }
    }
  }
}

/// The lower triangle of a'b, [column][column] with the blocks' stride, over rows from `first` on.
inline void make_gram(const Block& a, const Block& b, int first, Simd* gram) {
  constexpr int k_rows = 2;
  for (int c = 0; c < a.columns; c += k_block_columns) {
    for (int r = c; r < a.columns; r += k_rows) {
      accumulate<k_rows, true>(a.row(first) + r, 1, a.stride, b.row(first) + c, b.stride, a.rows - first,
                               gram + static_cast<long>(r) * a.stride + c, a.stride);
    }
  }
}

/// out = in rotation, with rotation [in column][out column] of the blocks' stride.
inline void rotate_block(const Block& in, const Simd* rotation, const Block& out) {
  for (int i = 0; i < out.rows; i += MOTTLE_TILE_ROWS) {
    for (int c = 0; c < out.columns; c += k_block_columns) {
      accumulate<MOTTLE_TILE_ROWS, true>(in.row(i), in.stride, 1, rotation + c, in.stride, in.columns, out.row(i) + c,
                                         out.stride);
    }
  }
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
