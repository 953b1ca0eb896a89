// Sums the terms of a family for one batch and brings a sample-dependent mass to standard form.
#pragma once

#include "linalg/batched/simd/term_sum.hpp"
#include "linalg/batched/simd/workspace.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// result = constant + sum of coefficient * term over `size` entries: all terms over some entries before the next,
/// which stay near.
inline void combine_terms(const double* terms, int count, long size, const double* coefficients, long stride,
                          const BatchSamples& batch, Simd* result) {
  constexpr long k_near = 256;
  const auto coefficient = [&](int term) MOTTLE_FLAT { return gather(coefficients, stride, term, batch); };
  for (long begin = 0; begin < size; begin += k_near) {
    const long entries = begin + k_near < size ? k_near : size - begin;
    sum_terms(terms + begin, size, count, coefficient, entries, result + begin);
  }
}

/// Columns of a packed lower triangle that are treated together, each indexed by its row.
template <int Columns>
struct PackedColumns {
  Simd* column[Columns];

  MOTTLE_INLINE PackedColumns(Simd* matrix, int n, int first) {
    for (int c = 0; c < Columns; ++c) column[c] = matrix + packed_index(n, first + c, first + c) - (first + c);
  }
  MOTTLE_INLINE Simd* operator[](int c) const { return column[c]; }
};

/// Columns [first, first + Columns) of the Cholesky factor, and what they take from the columns after them.
template <int Columns>
inline void factor_columns(Simd* mass, int n, int first, Mask& definite) {
  const PackedColumns<Columns> l(mass, n, first);
  for (int c = 0; c < Columns; ++c) {
    const int k = first + c;
    for (int q = 0; q < c; ++q) {
      const Simd multiplier = l[q][k];
      for (int i = k; i < n; ++i) l[c][i] -= multiplier * l[q][i];
    }
    definite &= l[c][k] > broadcast(0.0);
    const Simd root = square_root(l[c][k]);
    const Simd scale = reciprocal(root);
    l[c][k] = root;
    for (int i = k + 1; i < n; ++i) l[c][i] *= scale;
  }
  for (int j = first + Columns; j < n; ++j) {
    Simd* const target = mass + packed_index(n, j, j) - j;
    Simd multiplier[Columns];
    for (int c = 0; c < Columns; ++c) multiplier[c] = l[c][j];
    for (int i = j; i < n; ++i) {
      Simd entry = target[i];
      for (int c = 0; c < Columns; ++c) entry -= multiplier[c] * l[c][i];
      target[i] = entry;
    }
  }
}

/// Factors M = L L' in place, right-looking. Returns the lanes where M is numerically positive definite.
inline Mask factor_mass(Simd* mass, int n) {
  Mask definite = ~Mask{};
  const Simd scale = mass[0];
  int k = 0;
  for (; k + MOTTLE_TILE_ROWS <= n; k += MOTTLE_TILE_ROWS) factor_columns<MOTTLE_TILE_ROWS>(mass, n, k, definite);
  for (; k < n; ++k) factor_columns<1>(mass, n, k, definite);
  return definite & is_finite(scale);
}

/// Solves L x = b in place for some columns of a packed matrix, each below its diagonal.
template <int Columns>
inline void solve_columns(const Simd* factor, int n, int first, const PackedColumns<Columns>& x) {
  for (int j = first + 1; j < n; ++j) {
    const Simd* const l = factor + packed_index(n, j, j) - j;
    const Simd scale = reciprocal(l[j]);
    Simd value[Columns];
    if (j - first < Columns) {  // the others begin further down
      for (int c = 0; c < j - first; ++c) {
        x[c][j] = value[c] = x[c][j] * scale;
        for (int i = j + 1; i < n; ++i) x[c][i] -= value[c] * l[i];
      }
      continue;
    }
    for (int c = 0; c < Columns; ++c) x[c][j] = value[c] = x[c][j] * scale;
    for (int i = j + 1; i < n; ++i) {
      const Simd entry = l[i];
      for (int c = 0; c < Columns; ++c) x[c][i] -= value[c] * entry;
    }
  }
}

/// Columns [first, first + Columns) of L^-1 K L^-T and what they take from the columns after them. For one column,
///
///   k' = k / l^2,  a' = a/l - k' b,  A22 <- A22 - a'' b' - b (a'')' with a'' = a/l - k' b / 2, then a' <- L22^-1 a'
template <int Columns>
inline void reduce_columns(Simd* matrix, Simd* factor, int n, int first) {
  const PackedColumns<Columns> a(matrix, n, first), b(factor, n, first);
  Simd half[Columns];
  for (int c = 0; c < Columns; ++c) {
    const int k = first + c;
    for (int q = 0; q < c; ++q) {
      const Simd ak = a[q][k], bk = b[q][k];
      for (int i = k; i < n; ++i) a[c][i] -= a[q][i] * bk + b[q][i] * ak;
    }
    const Simd scale = reciprocal(b[c][k]);
    a[c][k] *= scale * scale;
    half[c] = a[c][k] * 0.5;
    for (int i = k + 1; i < n; ++i) a[c][i] = a[c][i] * scale - half[c] * b[c][i];
  }
  for (int j = first + Columns; j < n; ++j) {
    Simd* const target = matrix + packed_index(n, j, j) - j;
    Simd aj[Columns], bj[Columns];
    for (int c = 0; c < Columns; ++c) {
      aj[c] = a[c][j];
      bj[c] = b[c][j];
    }
    for (int i = j; i < n; ++i) {
      Simd entry = target[i];
      for (int c = 0; c < Columns; ++c) entry -= a[c][i] * bj[c] + b[c][i] * aj[c];
      target[i] = entry;
    }
  }
  for (int c = 0; c < Columns; ++c) {
    for (int i = first + c + 1; i < n; ++i) a[c][i] -= half[c] * b[c][i];
  }
  solve_columns<Columns>(factor, n, first, a);
}

/// matrix <- L^-1 K L^-T in place, some rows and columns at a time.
inline void reduce_by_full_mass(Simd* matrix, Simd* factor, int n) {
  int k = 0;
  for (; k + MOTTLE_TILE_ROWS <= n; k += MOTTLE_TILE_ROWS) reduce_columns<MOTTLE_TILE_ROWS>(matrix, factor, n, k);
  for (; k < n; ++k) reduce_columns<1>(matrix, factor, n, k);
}

/// matrix_ij <- K_ij / sqrt(m_i m_j); the diagonal is replaced by 1 / sqrt(m_i), the back-transformation.
inline Mask reduce_by_diagonal_mass(Simd* matrix, Simd* mass, int n) {
  Mask definite = ~Mask{};
  for (int i = 0; i < n; ++i) {
    definite &= mass[i] > broadcast(0.0);
    mass[i] = reciprocal_root(mass[i]);
  }
  for (int j = 0; j < n; ++j) {
    Simd* const column = matrix + packed_index(n, j, j) - j;
    for (int i = j; i < n; ++i) column[i] *= mass[i] * mass[j];
  }
  return definite;
}

/// Fills work.matrix with the batch's pencils in standard form; returns the lanes with a positive definite mass.
inline Mask assemble_standard_form(const Problem& problem, const BatchSamples& batch, const Workspace& work) {
  const int n = problem.order;
  const long packed = packed_index(n, n, n);
  combine_terms(problem.stiffness, problem.stiffness_terms, packed, problem.stiffness_coefficients,
                problem.stiffness_stride, batch, work.matrix);
  if (problem.mass_kind == MassKind::folded || problem.mass_kind == MassKind::folded_diagonal) return ~Mask{};
  const bool diagonal = problem.mass_kind == MassKind::diagonal;
  combine_terms(problem.mass, problem.mass_terms, diagonal ? n : packed, problem.mass_coefficients, problem.mass_stride,
                batch, work.mass);
  if (diagonal) return reduce_by_diagonal_mass(work.matrix, work.mass, n);
  const Mask definite = factor_mass(work.mass, n);
  reduce_by_full_mass(work.matrix, work.mass, n);
  return definite;
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
