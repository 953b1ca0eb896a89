// Rayleigh-Ritz on a block of vectors, and the count of eigenvalues that proves completeness. See davidson.hpp.
#pragma once

#include "linalg/batched/simd/davidson_workspace.hpp"
#include "linalg/batched/simd/solve.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// The first `vectors` vectors of work.small's pencil, into work.rotation [n][vectors].
inline void take_vectors(const DavidsonWorkspace& work, int n, int vectors) {
  for (int mode = 0; mode < vectors; ++mode) {
    const Simd* const x = work.small.vectors + static_cast<long>(mode) * n;
    for (int i = 0; i < n; ++i) work.rotation[static_cast<long>(i) * work.y.stride + mode] = x[i];
  }
}

/// Ritz values of the pencil in work.small's packed triangles, in work.small.values, and the vectors of the first.
inline Mask solve_ritz(const DavidsonWorkspace& work, int n, int values, int vectors) {
  const Workspace& small = work.small;
  Mask valid = factor_mass(small.mass, n);
  reduce_by_full_mass(small.matrix, small.mass, n);
  valid &= solve_standard_form(small, n, values, vectors);
  solve_upper(small.mass, n, vectors, small.vectors);
  take_vectors(work, n, vectors);
  return valid;
}

/// Standard form of the leading corner of the pencil; lanes in which its mass is positive definite.
inline Mask take_corner(const DavidsonProblem& problem, const DavidsonWorkspace& work) {
  const int n = problem.block;
  const Workspace& small = work.small;
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      const long entry = packed_index(n, i, j);
      small.matrix[entry] = tile_entry(work.stiffness, problem.order, i, j);
      if (problem.mass_terms > 0) small.mass[entry] = tile_entry(work.mass, problem.order, i, j);
    }
  }
  if (problem.mass_terms > 0) {
    const Mask definite = factor_mass(small.mass, n);
    reduce_by_full_mass(small.matrix, small.mass, n);
    return definite;
  }
  for (int i = 0; i < n; ++i) small.mass[i] = broadcast(problem.nominal_mass[i]);
  return reduce_by_diagonal_mass(small.matrix, small.mass, n);
}

constexpr int k_gaps = 3;  // between Ritz values, where eigenvalues may be counted

/// Rayleigh and Ritz: h, g, and values and vectors of their pencil.
inline Mask find_ritz(const DavidsonProblem& problem, const DavidsonWorkspace& work) {
  const int n = work.y.columns;
  make_gram(work.y, work.ky, 0, work.h);
  make_gram(work.y, work.my, 0, work.g);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      const long from = static_cast<long>(i) * work.y.stride + j;
      work.small.matrix[packed_index(n, i, j)] = work.h[from];
      work.small.mass[packed_index(n, i, j)] = work.g[from];
    }
  }
  const int counted = problem.modes + k_gaps < n ? problem.modes + k_gaps : n;
  return solve_ritz(work, n, counted > problem.kept ? counted : problem.kept, problem.kept);
}

/// Negative pivots of a packed symmetric matrix, eliminated in place; lanes with a pivot near zero become invalid.
inline Mask count_negative(Simd* matrix, int n, Mask& valid) {
  Mask count{};
  Simd scale = broadcast(0.0);
  for (int k = 0; k < n; ++k) scale = larger(scale, absolute(matrix[packed_index(n, k, k)]));
  for (int k = 0; k < n; ++k) {
    Simd* const column = matrix + packed_index(n, k, k) - k;
    count -= (column[k] < broadcast(0.0));
    valid &= absolute(column[k]) > scale * 1e-10;
    const Simd inverse = reciprocal(column[k]);
    for (int j = k + 1; j < n; ++j) {
      Simd* const target = matrix + packed_index(n, j, j) - j;
      const Simd multiplier = column[j] * inverse;
      for (int i = j; i < n; ++i) target[i] -= multiplier * column[i];
    }
  }
  return count;
}

/// Lanes in which no eigenvalue below some x above the wanted Ritz values is missed.
///
/// With S the block, R the rows of (K - x M) S below it and D a lower bound of K - x M there, the number of eigenvalues
/// below x is at most that of negative ones of S'(K - x M) S - R' D^-1 R: a congruence and a Schur complement. x lies
/// in the widest gap among the first Ritz values above the wanted ones.
///
///   D = alpha - (x - shift) beta m_i,   K(s) - shift M(s) >= alpha,   M(s) <= beta diag m
inline Mask misses_none(const DavidsonProblem& problem, const DavidsonWorkspace& work) {
  const int n = problem.block, modes = problem.modes;
  const Simd* const values = work.small.values;
  Simd widest = broadcast(-1.0), x = broadcast(0.0);
  Mask expected{};
  for (int p = modes; p < modes + k_gaps && p < n; ++p) {
    const Simd gap = (values[p] - values[p - 1]) / (values[p] - problem.shift);
    const Mask is_wider = gap > widest;
    widest = select(is_wider, gap, widest);
    x = select(is_wider, (values[p] + values[p - 1]) * 0.5, x);
    expected = is_wider ? Mask{} + p : expected;
  }
  Mask valid = widest > broadcast(0.0);
  const Simd heavy = (x - problem.shift) * work.beta;
  Block rows = work.spare;
  rows.columns = n;
  for (int i = n; i < problem.order; ++i) {
    const Simd stiff = work.alpha - heavy * problem.nominal_mass[i];
    valid &= stiff > work.alpha * 0.02;
    const Simd root = reciprocal_root(stiff);
    for (int c = 0; c < n; ++c) rows.row(i)[c] = (work.ky.row(i)[c] - x * work.my.row(i)[c]) * root;
  }
  make_gram(rows, rows, n, work.rest);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      const long from = static_cast<long>(i) * rows.stride + j;
      work.small.matrix[packed_index(n, i, j)] = work.h[from] - x * work.g[from] - work.rest[from];
    }
  }
  const Mask count = count_negative(work.small.matrix, n, valid);
  return valid & (count <= expected);
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
