// Eigenvectors of a symmetric tridiagonal matrix by inverse iteration; close eigenvalues are orthogonalised.
#pragma once

#include "linalg/batched/simd/workspace.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// T - shift = P L U by elimination with row exchanges: U has reciprocals r of its diagonal and two superdiagonals.
struct ShiftedFactor {
  Simd* reciprocal;
  Simd* upper;
  Simd* upper_second;
  Simd* lower;
  Mask* swapped;
};

/// Neighbouring modes treated side by side: each row waits for the one before, so several modes fill the wait.
template <int Count>
struct ModeGroup {
  ShiftedFactor factor[Count];
  Simd* x[Count];
  Simd value[Count];
  Simd largest[Count];  ///< magnitude of the largest entry of x
};

template <int Count>
inline ModeGroup<Count> mode_group(const Workspace& work, int n, int from) {
  ModeGroup<Count> group;
  for (int g = 0; g < Count; ++g) {
    Simd* const first = work.factor + static_cast<long>(4 * g) * n;
    group.factor[g] = {first, first + n, first + 2 * n, first + 3 * n, work.swapped + static_cast<long>(g) * n};
    group.x[g] = work.vectors + static_cast<long>(from + g) * n;
    group.value[g] = work.values[from + g];
  }
  return group;
}

template <int Count>
inline void factor_shifted(const Workspace& work, int n, Simd smallest_pivot, const ModeGroup<Count>& group) {
  const auto guarded = [&](Simd pivot)
                           MOTTLE_FLAT { return select(absolute(pivot) < smallest_pivot, smallest_pivot, pivot); };
  Simd pivot[Count], beside[Count];
  for (int g = 0; g < Count; ++g) {
    pivot[g] = work.diagonal[0] - group.value[g];
    beside[g] = work.offdiag[0];
  }
  for (int i = 0; i + 1 < n; ++i) {
    const Simd below = work.offdiag[i], diagonal = work.diagonal[i + 1], after = work.offdiag[i + 1];
    for (int g = 0; g < Count; ++g) {
      const ShiftedFactor& f = group.factor[g];
      const Simd next = diagonal - group.value[g];
      const Mask swap = absolute(below) > absolute(pivot[g]);
      const Simd inverse = reciprocal(guarded(select(swap, below, pivot[g])));
      const Simd multiplier = select(swap, pivot[g], below) * inverse;
      const Simd upper = select(swap, next, beside[g]);
      f.swapped[i] = swap;
      f.reciprocal[i] = inverse;
      f.lower[i] = multiplier;
      f.upper[i] = upper;
      f.upper_second[i] = select(swap, after, broadcast(0.0));
      pivot[g] = select(swap, beside[g], next) - multiplier * upper;
      beside[g] = select(swap, -multiplier * after, after);
    }
  }
  for (int g = 0; g < Count; ++g) {
    const ShiftedFactor& f = group.factor[g];
    f.reciprocal[n - 1] = reciprocal(guarded(pivot[g]));
    f.upper[n - 1] = f.upper_second[n - 1] = broadcast(0.0);
  }
}

template <int Count>
inline void eliminate(int n, const ModeGroup<Count>& group) {
  Simd carried[Count];
  for (int g = 0; g < Count; ++g) carried[g] = group.x[g][0];
  for (int i = 0; i + 1 < n; ++i) {
    for (int g = 0; g < Count; ++g) {
      const ShiftedFactor& f = group.factor[g];
      const Simd next = group.x[g][i + 1];
      const Simd kept = select(f.swapped[i], next, carried[g]);
      carried[g] = select(f.swapped[i], carried[g], next) - f.lower[i] * kept;
      group.x[g][i] = kept;
    }
  }
  for (int g = 0; g < Count; ++g) group.x[g][n - 1] = carried[g];
}

template <int Count>
inline void substitute_back(int n, ModeGroup<Count>& group) {
  Simd first[Count], second[Count], largest[Count];
  for (int g = 0; g < Count; ++g) first[g] = second[g] = largest[g] = broadcast(0.0);
  for (int i = n - 1; i >= 0; --i) {
    for (int g = 0; g < Count; ++g) {
      const ShiftedFactor& f = group.factor[g];
      const Simd value = (group.x[g][i] - f.upper_second[i] * second[g] - f.upper[i] * first[g]) * f.reciprocal[i];
      group.x[g][i] = value;
      largest[g] = larger(absolute(value), largest[g]);
      second[g] = first[g];
      first[g] = value;
    }
  }
  for (int g = 0; g < Count; ++g) group.largest[g] = largest[g];
}

MOTTLE_INLINE Simd dot(const Simd* x, const Simd* y, int n) {
  Simd even = broadcast(0.0), odd = broadcast(0.0);
  int i = 0;
  for (; i + 1 < n; i += 2) {
    even += x[i] * y[i];
    odd += x[i + 1] * y[i + 1];
  }
  if (i < n) even += x[i] * y[i];
  return even + odd;
}

/// Scales to unit length; the squares are of entries over the largest, so that they cannot overflow.
template <int Count>
inline void normalise(int n, const ModeGroup<Count>& group) {
  Simd scale[Count], sum[Count];
  for (int g = 0; g < Count; ++g) {
    scale[g] = reciprocal(group.largest[g]);
    sum[g] = broadcast(0.0);
  }
  for (int i = 0; i < n; ++i) {
    for (int g = 0; g < Count; ++g) {
      const Simd entry = group.x[g][i] = group.x[g][i] * scale[g];
      sum[g] += entry * entry;
    }
  }
  for (int g = 0; g < Count; ++g) scale[g] = reciprocal_root(sum[g]);
  for (int i = 0; i < n; ++i) {
    for (int g = 0; g < Count; ++g) group.x[g][i] *= scale[g];
  }
}

/// Removes from a mode's vector its parts along the earlier modes of its cluster and scales it to unit length again; an
/// exact no-op in the lanes where it has no cluster.
inline void orthogonalise(const Workspace& work, int n, int mode, Simd cluster_gap) {
  Simd* const x = work.vectors + static_cast<long>(mode) * n;
  Mask linked = ~Mask{}, changed{};
  for (int other = mode - 1; other >= 0; --other) {
    linked &= work.values[other + 1] - work.values[other] < cluster_gap;
    if (!any(linked)) break;
    changed |= linked;
    const Simd* const y = work.vectors + static_cast<long>(other) * n;
    const Simd part = select(linked, dot(x, y, n), broadcast(0.0));
    for (int i = 0; i < n; ++i) x[i] -= part * y[i];
  }
  if (!any(changed)) return;
  // Nearly all of it may have been taken away: first by the largest entry, so that no square is lost.
  Simd largest = broadcast(0.0);
  for (int i = 0; i < n; ++i) largest = larger(absolute(x[i]), largest);
  const Simd scale = select(changed, reciprocal(largest), broadcast(1.0));
  for (int i = 0; i < n; ++i) x[i] *= scale;
  const Simd unit = select(changed, reciprocal_root(dot(x, x, n)), broadcast(1.0));
  for (int i = 0; i < n; ++i) x[i] *= unit;
}

/// Fixed start vectors with no zero and no symmetry: entries in +-[0.5, 1) from a multiplicative sequence.
inline void start_vector(Simd* x, int n, int mode) {
  unsigned long long state = 0x9e3779b97f4a7c15ULL * static_cast<unsigned long long>(mode + 1);
  for (int i = 0; i < n; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double magnitude = 0.5 + static_cast<double>(state >> 34) * (0.5 / 1073741824.0);
    x[i] = broadcast((state >> 33 & 1U) != 0 ? magnitude : -magnitude);
  }
}

/// Largest entry of T z - lambda z for each mode of a group.
template <int Count>
inline void find_residuals(const Workspace& work, int n, const ModeGroup<Count>& group, Simd* residuals) {
  Simd before[Count], largest[Count];
  for (int g = 0; g < Count; ++g) before[g] = largest[g] = broadcast(0.0);
  for (int i = 0; i < n; ++i) {
    const Simd diagonal = work.diagonal[i], coupling = work.offdiag[i];
    const int beyond = i + 1 < n ? i + 1 : i;  // the last coupling is zero
    for (int g = 0; g < Count; ++g) {
      const Simd* const z = group.x[g];
      const Simd entry = absolute((diagonal - group.value[g]) * z[i] + before[g] + coupling * z[beyond]);
      largest[g] = select(entry <= largest[g], largest[g], entry);  // keeps a nan
      before[g] = coupling * z[i];
    }
  }
  for (int g = 0; g < Count; ++g) residuals[g] = largest[g];
}

/// Vectors of modes [from, from + Count); returns the lanes in which every residual is small.
template <int Count>
inline Mask iterate_group(const Workspace& work, int n, int from, Simd bound, int iterations) {
  const Simd cluster_gap = bound * 1e-3;  // vectors of more distant eigenvalues are orthogonal to about 1e-13
  ModeGroup<Count> group = mode_group<Count>(work, n, from);
  factor_shifted<Count>(work, n, bound * k_epsilon, group);
  for (int g = 0; g < Count; ++g) start_vector(group.x[g], n, from + g);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    if (iteration > 0) eliminate<Count>(n, group);
    substitute_back<Count>(n, group);
    normalise<Count>(n, group);
    for (int g = 0; g < Count; ++g) orthogonalise(work, n, from + g, cluster_gap);
  }
  for (int g = 0; g < Count; ++g) orthogonalise(work, n, from + g, cluster_gap);
  Simd residuals[Count];
  find_residuals<Count>(work, n, group, residuals);
  Mask valid = ~Mask{};
  for (int g = 0; g < Count; ++g) valid &= residuals[g] <= bound * 1e-13;
  return valid;
}

/// Fills work.vectors with orthonormal eigenvectors of T; returns the lanes in which every residual is small. One
/// iteration finds the vector unless the start was unlucky, two more polish.
inline Mask iterate_vectors(const Workspace& work, int n, int modes, Simd bound, int iterations = 3) {
  Mask valid = ~Mask{};
  int mode = 0;
  for (; mode + k_vector_group <= modes; mode += k_vector_group) {
    valid &= iterate_group<k_vector_group>(work, n, mode, bound, iterations);
  }
  for (; mode < modes; ++mode) valid &= iterate_group<1>(work, n, mode, bound, iterations);
  return valid;
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
