// Pencils of 9 to 400 degrees of freedom, one batch after another. Included by one file per register width, which
// sets MOTTLE_LANES and how much is treated side by side: as much as the registers hold, see MOTTLE_UPDATE_COLUMNS and
// MOTTLE_PRODUCT_COLUMNS in tridiagonalise.hpp, MOTTLE_VECTOR_GROUP in workspace.hpp.
#pragma once

#include "linalg/batched/simd/assemble.hpp"
#include "linalg/batched/simd/tridiagonal_values.hpp"
#include "linalg/batched/simd/tridiagonal_vectors.hpp"
#include "linalg/batched/simd/tridiagonalise.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// x_c <- L^-T x_c for a constant L^-T given by columns; row i needs rows i and below only, so it can go in place.
template <int Columns>
MOTTLE_INLINE void apply_back_transform(const double* transform, int n, Simd* x) {
  for (int i = 0; i < n; ++i) {
    Simd sum[Columns];
    for (int c = 0; c < Columns; ++c) sum[c] = x[c * n + i] * transform[i * n + i];
    for (int j = i + 1; j < n; ++j) {
      const double entry = transform[static_cast<long>(j) * n + i];
      for (int c = 0; c < Columns; ++c) sum[c] += x[c * n + j] * entry;
    }
    for (int c = 0; c < Columns; ++c) x[c * n + i] = sum[c];
  }
}

/// x_c <- L^-T x_c with the lanes' own packed factor, for vectors that lie n apart.
template <int Columns>
inline void solve_upper(const Simd* factor, int n, Simd* x) {
  for (int i = n - 1; i >= 0; --i) {
    const Simd* const column = factor + packed_index(n, i, i) - i;
    const Simd scale = reciprocal(column[i]);
    Simd sum[Columns];
    for (int c = 0; c < Columns; ++c) sum[c] = x[c * n + i];
    for (int j = i + 1; j < n; ++j) {
      const Simd entry = column[j];
      for (int c = 0; c < Columns; ++c) sum[c] -= entry * x[c * n + j];
    }
    for (int c = 0; c < Columns; ++c) x[c * n + i] = sum[c] * scale;
  }
}

inline void solve_upper(const Simd* factor, int n, int vectors, Simd* x) {
  int v = 0;
  for (; v + 5 <= vectors; v += 5) solve_upper<5>(factor, n, x + static_cast<long>(v) * n);
  for (; v < vectors; ++v) solve_upper<1>(factor, n, x + static_cast<long>(v) * n);
}

/// From vectors of the standard form to M-normalised modes.
inline void undo_reduction(const Problem& problem, const Workspace& work) {
  const int n = problem.order, modes = problem.modes;
  if (problem.mass_kind == MassKind::full) return solve_upper(work.mass, n, modes, work.vectors);
  int mode = 0;
  if (problem.mass_kind == MassKind::folded) {
    for (; mode + 5 <= modes; mode += 5) {
      apply_back_transform<5>(problem.back_transform, n, work.vectors + static_cast<long>(mode) * n);
    }
  }
  for (; mode < modes; ++mode) {
    Simd* const x = work.vectors + static_cast<long>(mode) * n;
    switch (problem.mass_kind) {
      case MassKind::folded:
        apply_back_transform<1>(problem.back_transform, n, x);
        break;
      case MassKind::folded_diagonal:
        for (int i = 0; i < n; ++i) x[i] *= problem.back_transform[static_cast<long>(i) * n + i];
        break;
      case MassKind::diagonal:
        for (int i = 0; i < n; ++i) x[i] *= work.mass[i];
        break;
      case MassKind::full:
        break;
    }
  }
}

/// Makes the largest component of a mode positive; returns the lanes in which every component is finite.
inline Mask fix_sign(Simd* x, int n) {
  Simd largest = x[0];
  Mask finite = is_finite(x[0]);
  for (int i = 1; i < n; ++i) {
    finite &= is_finite(x[i]);
    largest = select(absolute(x[i]) > absolute(largest), x[i], largest);
  }
  const Mask sign = sign_bits(largest);
  for (int i = 0; i < n; ++i) x[i] = without_negative_zero(flip_sign(x[i], sign));
  return finite;
}

inline void store_batch(const Problem& problem, const Output& output, const BatchSamples& batch, const Workspace& work,
                        Mask valid) {
  const long length = static_cast<long>(problem.order) * problem.modes;
  for (int lane = 0; lane < batch.count; ++lane) {
    const long sample = batch.sample[lane];
    output.valid[sample] = valid[lane] != 0;
    double* const values = output.values + sample * problem.modes;
    for (int mode = 0; mode < problem.modes; ++mode) values[mode] = work.values[mode][lane];
    if (!problem.vectors) continue;
    double* const vectors = output.vectors + sample * length;
    for (long entry = 0; entry < length; ++entry) vectors[entry] = work.vectors[entry][lane];
  }
}

/// Values of the standard form in work.matrix, ascending, and vectors of the first of them; `rounding` and `iterations`
/// as find_eigenvalues and iterate_vectors take them. Returns the lanes in which every residual is small.
inline Mask solve_standard_form(const Workspace& work, int n, int values, int vectors, double rounding = k_epsilon,
                                int iterations = 3) {
  tridiagonalise(work, n);
  const Simd bound = eigenvalue_bound(work, n);
  find_eigenvalues(work, n, values, bound, rounding);
  const Mask valid = is_finite(bound * 4.0) & iterate_vectors(work, n, vectors, bound, iterations);
  transform_back(work, n, vectors);
  return valid;
}

void solve_large(const Problem& problem, const Output& output, long begin, long end, double* memory) {
  const Workspace work(problem, memory);
  const int n = problem.order;
  for (long first = begin; first < end; first += MOTTLE_LANES) {
    const BatchSamples batch = batch_samples(first, end);
    Mask valid = assemble_standard_form(problem, batch, work);
    valid &= solve_standard_form(work, n, problem.modes, problem.vectors ? problem.modes : 0);
    if (problem.vectors) {
      undo_reduction(problem, work);
      for (int mode = 0; mode < problem.modes; ++mode) valid &= fix_sign(work.vectors + static_cast<long>(mode) * n, n);
    }
    store_batch(problem, output, batch, work, valid);
  }
}

long workspace_doubles(const Problem& problem) {
  return Workspace(problem, nullptr).total_values * MOTTLE_LANES;
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
