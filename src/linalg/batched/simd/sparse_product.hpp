// Products of a sparse symmetric matrix with many vectors at once: here the lanes hold vectors, not samples.
#pragma once

#include "linalg/batched/simd/unaligned.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Offsets of the matrix' rows in arrays of vectors [row][vector].
template <bool IsGathered>
struct RowIndices {
  const int* indices;
  long width;

  MOTTLE_INLINE long operator()(int row) const { return (IsGathered ? indices[row] : row) * width; }
};

/// One panel of Registers * MOTTLE_LANES vectors: the column's own vectors stay in registers.
template <int Registers, bool IsScaled, typename In, typename Out>
MOTTLE_INLINE void add_panel(const SparseLower& a, const In& in_row, const Out& out_row, const double* scales,
                             const double* in, double* out) {
  Simd factors[Registers];
  for (int l = 0; l < Registers; ++l) factors[l] = IsScaled ? load(scales + l * MOTTLE_LANES) : broadcast(1.0);
  for (int j = 0; j < a.columns; ++j) {
    const double* const source = in + in_row(j);
    Simd x[Registers], scaled[Registers], sum[Registers];
    for (int l = 0; l < Registers; ++l) {
      x[l] = load(source + l * MOTTLE_LANES);
      scaled[l] = IsScaled ? x[l] * factors[l] : x[l];
      sum[l] = broadcast(0.0);
    }
    for (int k = a.starts[j]; k < a.starts[j + 1]; ++k) {
      const int i = a.rows[k];
      const Simd value = broadcast(a.values[k]);
      if (i == j) {
        for (int l = 0; l < Registers; ++l) sum[l] += value * x[l];
        continue;
      }
      const double* const other = in + in_row(i);
      double* const target = out + out_row(i);
      for (int l = 0; l < Registers; ++l) {
        sum[l] += value * load(other + l * MOTTLE_LANES);
        store(target + l * MOTTLE_LANES, load(target + l * MOTTLE_LANES) + value * scaled[l]);
      }
    }
    double* const target = out + out_row(j);
    for (int l = 0; l < Registers; ++l) {
      const Simd own = IsScaled ? sum[l] * factors[l] : sum[l];
      store(target + l * MOTTLE_LANES, load(target + l * MOTTLE_LANES) + own);
    }
  }
}

template <bool IsScaled, typename In, typename Out>
MOTTLE_INLINE void add_panels(const SparseLower& a, const In& in_row, const Out& out_row, const double* scales,
                              int width, const double* in, double* out) {
  int first = 0;
  const auto add = [&](auto registers) MOTTLE_FLAT {
    constexpr int k_registers = registers.value;
    for (; first + k_registers * MOTTLE_LANES <= width; first += k_registers * MOTTLE_LANES) {
      add_panel<k_registers, IsScaled>(a, in_row, out_row, IsScaled ? scales + first : nullptr, in + first,
                                       out + first);
    }
  };
  add(Index<4>{});
  add(Index<2>{});
  add(Index<1>{});
}

void add_symmetric_product(const SparseLower& a, int width, const double* in, double* out) {
  const RowIndices<false> all{nullptr, width};
  add_panels<false>(a, all, all, nullptr, width, in, out);
}

void add_scaled_product(const SparseLower& a, const double* scales, int width, const double* in, double* out) {
  const RowIndices<true> own{a.row_indices, width};
  add_panels<true>(a, own, own, scales, width, in, out);
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
