// Triangular solutions with a supernodal L, some right-hand sides at once: here too the lanes hold vectors. A BLAS
// rearranges L before it computes, which pays for hundreds of right-hand sides; for fewer it is faster to let L stream
// through the registers just as it lies.
#pragma once

#include "linalg/batched/simd/unaligned.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Two registers of right-hand sides, so that an entry of L is broadcast once for both.
struct SimdPair {
  Simd first, second;
};

MOTTLE_INLINE void get(const double* from, double& value) {
  value = *from;
}
MOTTLE_INLINE void get(const double* from, Simd& value) {
  value = load(from);
}
MOTTLE_INLINE void get(const double* from, SimdPair& value) {
  value = {load(from), load(from + MOTTLE_LANES)};
}
MOTTLE_INLINE void put(double* to, double value) {
  *to = value;
}
MOTTLE_INLINE void put(double* to, Simd value) {
  store(to, value);
}
MOTTLE_INLINE void put(double* to, const SimdPair& value) {
  store(to, value.first);
  store(to + MOTTLE_LANES, value.second);
}

/// sum -= side * entry within one expression: only so it becomes one rounding for each kind of value in every build,
/// and a right-hand side has the same bits alone, in a register and in a pair.
MOTTLE_INLINE void take_out(double& sum, double side, double entry) {
  sum -= side * entry;
}
MOTTLE_INLINE void take_out(Simd& sum, Simd side, double entry) {
  sum -= side * entry;
}
MOTTLE_INLINE void take_out(SimdPair& sum, const SimdPair& side, double entry) {
  sum.first -= side.first * entry;
  sum.second -= side.second * entry;
}
MOTTLE_INLINE void scale(double& side, double factor) {
  side *= factor;
}
MOTTLE_INLINE void scale(Simd& side, double factor) {
  side *= factor;
}
MOTTLE_INLINE void scale(SimdPair& side, double factor) {
  side.first *= factor;
  side.second *= factor;
}

/// Columns that are worked on together: their right-hand sides, a pair of values each, stay in registers, of which
/// AVX-512 has 32 and what came before it 16.
constexpr int k_block = MOTTLE_LANES == 8 ? 8 : 6;

/// Neighbouring columns of a supernode from their diagonal downwards.
struct ColumnBlock {
  int columns;
  int row_count;         ///< the first rows are those of the diagonal
  const int* rows;       ///< of L and of x
  const double* values;  ///< by columns
  long stride;

  MOTTLE_INLINE double at(int row, int column) const { return values[column * stride + row]; }
  MOTTLE_INLINE double* row(double* x, int width, int i) const { return x + static_cast<long>(rows[i]) * width; }
};

MOTTLE_INLINE ColumnBlock column_block(const SupernodalLower& lower, int supernode, int first) {
  const int begin = lower.row_starts[supernode];
  const int rows = lower.row_starts[supernode + 1] - begin;
  const int columns = lower.columns[supernode + 1] - lower.columns[supernode] - first;
  return {columns < k_block ? columns : k_block, rows - first, lower.rows + begin + first,
          lower.values + lower.value_starts[supernode] + static_cast<long>(first) * rows + first, rows};
}

/// The processor foresees how L goes on within a column, not from one short column to the next. Work on row i of a
/// block fetches the i-th part of its neighbour, a cache line or less; past the ends of L that is harmless.
template <int Columns>
MOTTLE_INLINE void fetch_neighbour(const ColumnBlock& block, int direction, int i) {
  constexpr int k_into_second_cache = 2;
  __builtin_prefetch(block.values + Columns * (direction * block.stride + i), 0, k_into_second_cache);
}

/// Solves with the triangle on top of the block and subtracts its product from the rows below. Divisions would wait for
/// each other; the reciprocals do not.
template <typename Value, int Columns>
MOTTLE_INLINE void eliminate(const ColumnBlock& block, int width, double* x) {
  Value own[Columns];
  unrolled<0, Columns>([&](auto column) MOTTLE_FLAT {
    constexpr int c = column.value;
    get(block.row(x, width, c), own[c]);
    unrolled<0, c>([&](auto d) MOTTLE_FLAT { take_out(own[c], own[d.value], block.at(c, d.value)); });
    scale(own[c], 1.0 / block.at(c, c));
    put(block.row(x, width, c), own[c]);
  });
  for (int i = Columns; i < block.row_count; ++i) {
    fetch_neighbour<Columns>(block, 1, i);
    Value sum;
    get(block.row(x, width, i), sum);
    for (int c = 0; c < Columns; ++c) take_out(sum, own[c], block.at(i, c));
    put(block.row(x, width, i), sum);
  }
}

/// Takes the rows below out of the block's own and solves with the transpose of its triangle.
template <typename Value, int Columns>
MOTTLE_INLINE void substitute_back(const ColumnBlock& block, int width, double* x) {
  Value own[Columns];
  for (int c = 0; c < Columns; ++c) get(block.row(x, width, c), own[c]);
  for (int i = Columns; i < block.row_count; ++i) {
    fetch_neighbour<Columns>(block, -1, i);
    Value below;
    get(block.row(x, width, i), below);
    for (int c = 0; c < Columns; ++c) take_out(own[c], below, block.at(i, c));
  }
  unrolled<0, Columns>([&](auto from_last) MOTTLE_FLAT {
    constexpr int c = Columns - 1 - from_last.value;
    unrolled<c + 1, Columns>([&](auto d) MOTTLE_FLAT { take_out(own[c], own[d.value], block.at(d.value, c)); });
    scale(own[c], 1.0 / block.at(c, c));
    put(block.row(x, width, c), own[c]);
  });
}

template <bool IsBack, typename Value, int Columns>
MOTTLE_INLINE void solve_block(const ColumnBlock& block, int width, double* x) {
  if constexpr (IsBack) {
    substitute_back<Value, Columns>(block, width, x);
  } else {
    eliminate<Value, Columns>(block, width, x);
  }
}

/// One block for all right-hand sides: it comes from memory for the first register and from the cache for the others. A
/// function of its own, or the loops over the supernodes take its registers.
template <bool IsBack, int Columns>
__attribute__((noinline)) void solve_sides(const ColumnBlock& block, int width, double* x) {
  if (width == 1) {
    solve_block<IsBack, double, Columns>(block, width, x);
  } else {
    int side = 0;
    for (; side + 2 * MOTTLE_LANES <= width; side += 2 * MOTTLE_LANES) {
      solve_block<IsBack, SimdPair, Columns>(block, width, x + side);
    }
    if (side < width) solve_block<IsBack, Simd, Columns>(block, width, x + side);
  }
}

template <bool IsBack, int Columns = k_block>
MOTTLE_INLINE void dispatch(const ColumnBlock& block, int width, double* x) {
  if (block.columns == Columns) {
    solve_sides<IsBack, Columns>(block, width, x);
  } else if constexpr (Columns > 1) {
    dispatch<IsBack, Columns - 1>(block, width, x);
  }
}

void solve_lower(const SupernodalLower& lower, int width, double* x) {
  for (int s = 0; s < lower.supernodes; ++s) {
    const int columns = lower.columns[s + 1] - lower.columns[s];
    for (int first = 0; first < columns; first += k_block) {
      dispatch<false>(column_block(lower, s, first), width, x);
    }
  }
}

void solve_lower_transposed(const SupernodalLower& lower, int width, double* x) {
  for (int s = lower.supernodes - 1; s >= 0; --s) {
    const int columns = lower.columns[s + 1] - lower.columns[s];
    for (int first = (columns - 1) / k_block * k_block; first >= 0; first -= k_block) {
      dispatch<true>(column_block(lower, s, first), width, x);
    }
  }
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
