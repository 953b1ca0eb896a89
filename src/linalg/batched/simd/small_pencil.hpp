// A pencil of up to 8 degrees of freedom in registers: sums of terms, and Cholesky reduction to standard form.
#pragma once

#include "linalg/batched/simd/simd.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// A pencil in standard form: packed symmetric matrix, and the columns that Jacobi turns into eigenvectors.
template <int N>
struct SmallPencil {
  Simd matrix[N * (N + 1) / 2];
  Simd columns[N][N];  // [column][row]
  Mask valid;

  static constexpr int index(int i, int j) {
    return static_cast<int>(i >= j ? packed_index(N, i, j) : packed_index(N, j, i));
  }
};

/// result = constant + sum of coefficient * term, entry by entry.
template <int Size>
MOTTLE_INLINE void combine(const double* terms, int count, const double* coefficients, long stride,
                           const BatchSamples& batch, Simd* result) {
  unrolled<0, Size>([&](auto entry) MOTTLE_FLAT { result[entry.value] = broadcast(terms[entry.value]); });
  for (int term = 0; term < count; ++term) {
    const double* matrix = terms + (term + 1) * Size;
    const Simd coefficient = gather(coefficients, stride, term, batch);
    unrolled<0, Size>([&](auto entry) MOTTLE_FLAT { result[entry.value] += coefficient * matrix[entry.value]; });
  }
}

/// W = L^-1 of M = L L'; lanes whose M is not numerically positive definite become invalid.
template <int N>
MOTTLE_INLINE void invert_cholesky_factor(const Simd (&mass)[N * (N + 1) / 2], Simd (&inverse)[N][N], Mask& valid) {
  using Pencil = SmallPencil<N>;
  Simd factor[N][N];
  unrolled<0, N>([&](auto column) MOTTLE_FLAT {
    constexpr int j = column.value;
    Simd pivot = mass[Pencil::index(j, j)];
    unrolled<0, j>([&](auto k) MOTTLE_FLAT { pivot -= factor[j][k.value] * factor[j][k.value]; });
    valid &= pivot > mass[Pencil::index(j, j)] * (N * 4 * k_epsilon);
    const Simd scale = reciprocal_root(pivot);
    inverse[j][j] = scale;
    unrolled<j + 1, N>([&](auto row) MOTTLE_FLAT {
      constexpr int i = row.value;
      Simd sum = mass[Pencil::index(i, j)];
      unrolled<0, j>([&](auto k) MOTTLE_FLAT { sum -= factor[i][k.value] * factor[j][k.value]; });
      factor[i][j] = sum * scale;
    });
  });
  unrolled<0, N>([&](auto column) MOTTLE_FLAT {
    constexpr int j = column.value;
    unrolled<j + 1, N>([&](auto row) MOTTLE_FLAT {
      constexpr int i = row.value;
      Simd sum = factor[i][j] * inverse[j][j];
      unrolled<j + 1, i>([&](auto k) MOTTLE_FLAT { sum += factor[i][k.value] * inverse[k.value][j]; });
      inverse[i][j] = -sum * inverse[i][i];
    });
  });
}

/// matrix <- W K W', columns <- W'.
template <int N>
MOTTLE_INLINE void reduce_to_standard_form(const Simd (&mass)[N * (N + 1) / 2], SmallPencil<N>& pencil) {
  using Pencil = SmallPencil<N>;
  Simd inverse[N][N];
  invert_cholesky_factor<N>(mass, inverse, pencil.valid);
  Simd product[N][N];
  unrolled<0, N>([&](auto row) MOTTLE_FLAT {
    unrolled<0, N>([&](auto column) MOTTLE_FLAT {
      constexpr int i = row.value, j = column.value;
      Simd sum = inverse[i][0] * pencil.matrix[Pencil::index(0, j)];
      unrolled<1, i + 1>([&](auto k)
                             MOTTLE_FLAT { sum += inverse[i][k.value] * pencil.matrix[Pencil::index(k.value, j)]; });
      product[i][j] = sum;
      pencil.columns[i][j] = j <= i ? inverse[i][j] : broadcast(0.0);
    });
  });
  unrolled<0, N>([&](auto column) MOTTLE_FLAT {
    unrolled<column.value, N>([&](auto row) MOTTLE_FLAT {
      constexpr int i = row.value, j = column.value;
      Simd sum = product[i][0] * inverse[j][0];
      unrolled<1, j + 1>([&](auto k) MOTTLE_FLAT { sum += product[i][k.value] * inverse[j][k.value]; });
      pencil.matrix[Pencil::index(i, j)] = sum;
    });
  });
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
