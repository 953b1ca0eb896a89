// Sums the terms of a family for one batch and brings a sample-dependent mass to standard form.
#pragma once

#include "linalg/lanes/workspace.hpp"

namespace mottle::lane_kernels {
namespace {

/// result = constant + sum of coefficient * term over `size` entries. Terms go four at a time through registers.
inline void combine_terms(const double* terms, int count, long size, const double* coefficients, long stride,
                          const BatchSamples& batch, Lane* result) {
  for (long entry = 0; entry < size; ++entry) result[entry] = broadcast(terms[entry]);
  int term = 0;
  for (; term + 4 <= count; term += 4) {
    const double* matrix = terms + (term + 1) * size;
    const Lane c0 = gather(coefficients, stride, term, batch), c1 = gather(coefficients, stride, term + 1, batch);
    const Lane c2 = gather(coefficients, stride, term + 2, batch), c3 = gather(coefficients, stride, term + 3, batch);
    for (long entry = 0; entry < size; ++entry) {
      result[entry] += c0 * matrix[entry] + c1 * matrix[entry + size] + c2 * matrix[entry + 2 * size] +
                       c3 * matrix[entry + 3 * size];
    }
  }
  for (; term < count; ++term) {
    const double* matrix = terms + (term + 1) * size;
    const Lane coefficient = gather(coefficients, stride, term, batch);
    for (long entry = 0; entry < size; ++entry) result[entry] += coefficient * matrix[entry];
  }
}

/// Factors M = L L' in place, right-looking. Returns the lanes where M is numerically positive definite.
inline Mask factor_mass(Lane* mass, int n) {
  Mask definite = ~Mask{};
  const Lane scale = mass[0];
  for (int k = 0; k < n; ++k) {
    Lane* const column = mass + packed_index(n, k, k) - k;
    definite &= column[k] > broadcast(0.0);
    const Lane root = square_root(column[k]);
    const Lane reciprocal = broadcast(1.0) / root;
    column[k] = root;
    for (int i = k + 1; i < n; ++i) column[i] *= reciprocal;
    for (int j = k + 1; j < n; ++j) {
      Lane* const target = mass + packed_index(n, j, j) - j;
      const Lane multiplier = column[j];
      for (int i = j; i < n; ++i) target[i] -= multiplier * column[i];
    }
  }
  return definite & is_finite(scale);
}

/// Solves L x = b in place for the trailing block that starts at row `first`.
inline void solve_lower(const Lane* factor, int n, int first, Lane* x) {
  for (int j = first; j < n; ++j) {
    const Lane* const column = factor + packed_index(n, j, j) - j;
    const Lane value = x[j] / column[j];
    x[j] = value;
    for (int i = j + 1; i < n; ++i) x[i] -= value * column[i];
  }
}

/// matrix <- L^-1 K L^-T in place, one row and column at a time.
///
///   k' = k / l^2,  a' = a/l - k' b,  A22 <- A22 - a'' b' - b a''' with a'' = a/l - k' b / 2, then a' <- L22^-1 a'
inline void reduce_by_full_mass(Lane* matrix, const Lane* factor, int n) {
  for (int k = 0; k < n; ++k) {
    Lane* const a = matrix + packed_index(n, k, k) - k;
    const Lane* const b = factor + packed_index(n, k, k) - k;
    const Lane reciprocal = broadcast(1.0) / b[k];
    a[k] *= reciprocal * reciprocal;
    const Lane half = a[k] * 0.5;
    for (int i = k + 1; i < n; ++i) a[i] = a[i] * reciprocal - half * b[i];
    for (int j = k + 1; j < n; ++j) {
      Lane* const target = matrix + packed_index(n, j, j) - j;
      const Lane aj = a[j], bj = b[j];
      for (int i = j; i < n; ++i) target[i] -= a[i] * bj + b[i] * aj;
    }
    for (int i = k + 1; i < n; ++i) a[i] -= half * b[i];
    solve_lower(factor, n, k + 1, a);
  }
}

/// matrix_ij <- K_ij / sqrt(m_i m_j); the diagonal is replaced by 1 / sqrt(m_i), the back-transformation.
inline Mask reduce_by_diagonal_mass(Lane* matrix, Lane* mass, int n) {
  Mask definite = ~Mask{};
  for (int i = 0; i < n; ++i) {
    definite &= mass[i] > broadcast(0.0);
    mass[i] = broadcast(1.0) / square_root(mass[i]);
  }
  for (int j = 0; j < n; ++j) {
    Lane* const column = matrix + packed_index(n, j, j) - j;
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
}  // namespace mottle::lane_kernels
