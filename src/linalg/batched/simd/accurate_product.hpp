// Products of a sparse symmetric matrix with many vectors at once, as accurate as if they were found in twice the
// precision and rounded once: for vectors in whose products large terms cancel, such as motions that hardly strain a
// stiff structure. Source: [Ogita2005], Dot2.
#pragma once

#include "linalg/batched/simd/sparse_product.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Keeps the compiler from merging a product with what follows.
MOTTLE_INLINE Simd rounded(Simd x) {
#if defined(__x86_64__)
  asm("" : "+x"(x));
#else
  asm("" : "+m"(x));
#endif
  return x;
}

#if !defined(__FMA__)
/// The upper half of the digits of x.
MOTTLE_INLINE Simd upper_half(Simd x) {
  const Simd scaled = rounded(x * 134217729.0);  // 2^27 + 1
  return scaled - rounded(scaled - x);
}
#endif

/// a x - product without error, where product is a x rounded.
MOTTLE_INLINE Simd product_error(Simd a, Simd x, Simd product) {
#if defined(__AVX512F__)
  return _mm512_fmsub_pd(a, x, product);
#elif defined(__FMA__)
  return _mm256_fmsub_pd(a, x, product);
#else
  const Simd a_upper = upper_half(a), a_lower = a - a_upper, x_upper = upper_half(x), x_lower = x - x_upper;
  return ((rounded(a_upper * x_upper) - product) + rounded(a_upper * x_lower) + rounded(a_lower * x_upper)) +
         rounded(a_lower * x_lower);
#endif
}

/// A sum in two parts; the second one is what the first one lost.
struct AccurateSum {
  Simd value, rest;

  MOTTLE_INLINE void add(Simd term) {
    const Simd next = value + term, added = next - value;
    rest += (value - (next - added)) + (term - added);
    value = next;
  }
  MOTTLE_INLINE void add_product(Simd a, Simd x) {
    const Simd product = rounded(a * x);
    add(product);
    rest += product_error(a, x, product);
  }
};

/// One panel, see add_panel; `rest` is of the form of `out`.
template <int Registers, typename In, typename Out>
MOTTLE_INLINE void add_accurate_panel(const SparseLower& a, const In& in_row, const Out& out_row, const double* in,
                                      double* out, double* rest) {
  for (int j = 0; j < a.columns; ++j) {
    const double* const source = in + in_row(j);
    Simd x[Registers];
    AccurateSum own[Registers];
    for (int l = 0; l < Registers; ++l) {
      x[l] = load(source + l * MOTTLE_LANES);
      own[l] = {load(out + out_row(j) + l * MOTTLE_LANES), load(rest + out_row(j) + l * MOTTLE_LANES)};
    }
    for (int k = a.starts[j]; k < a.starts[j + 1]; ++k) {
      const int i = a.rows[k];
      const Simd value = broadcast(a.values[k]);
      if (i == j) {
        for (int l = 0; l < Registers; ++l) own[l].add_product(value, x[l]);
        continue;
      }
      const double* const other = in + in_row(i);
      const long target = out_row(i);
      for (int l = 0; l < Registers; ++l) {
        own[l].add_product(value, load(other + l * MOTTLE_LANES));
        AccurateSum sum{load(out + target + l * MOTTLE_LANES), load(rest + target + l * MOTTLE_LANES)};
        sum.add_product(value, x[l]);
        store(out + target + l * MOTTLE_LANES, sum.value);
        store(rest + target + l * MOTTLE_LANES, sum.rest);
      }
    }
    for (int l = 0; l < Registers; ++l) {
      store(out + out_row(j) + l * MOTTLE_LANES, own[l].value);
      store(rest + out_row(j) + l * MOTTLE_LANES, own[l].rest);
    }
  }
}

void add_local_product(const SparseLower& a, int width, const double* in, double* out, double* rest) {
  const RowIndices<true> in_row{a.row_indices, width};
  const RowIndices<false> out_row{nullptr, width};
  int first = 0;
  const auto add = [&](auto registers) MOTTLE_FLAT {
    constexpr int k_registers = registers.value;
    for (; first + k_registers * MOTTLE_LANES <= width; first += k_registers * MOTTLE_LANES) {
      add_accurate_panel<k_registers>(a, in_row, out_row, in + first, out + first, rest + first);
    }
  };
  add(Index<2>{});
  add(Index<1>{});
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
