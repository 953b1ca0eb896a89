// Eigenvectors of a symmetric tridiagonal matrix by inverse iteration; close eigenvalues are orthogonalised.
#pragma once

#include "linalg/lanes/workspace.hpp"

namespace mottle::lane_kernels {
namespace {

/// T - shift = P L U by elimination with row exchanges: U has reciprocals r of its diagonal and two superdiagonals.
struct ShiftedFactor {
  Lane* reciprocal;
  Lane* upper;
  Lane* upper_second;
  Lane* lower;
  Mask* swapped;
};

inline ShiftedFactor factor_shifted(const Workspace& work, int n, Lane shift, Lane smallest_pivot) {
  const ShiftedFactor f{work.factor, work.factor + n, work.factor + 2 * n, work.factor + 3 * n, work.swapped};
  const auto guarded = [&](Lane pivot)
                           MOTTLE_FLAT { return select(absolute(pivot) < smallest_pivot, smallest_pivot, pivot); };
  Lane pivot = work.diagonal[0] - shift, beside = work.offdiag[0];
  for (int i = 0; i + 1 < n; ++i) {
    const Lane below = work.offdiag[i], next = work.diagonal[i + 1] - shift, after = work.offdiag[i + 1];
    const Mask swap = absolute(below) > absolute(pivot);
    const Lane reciprocal = broadcast(1.0) / guarded(select(swap, below, pivot));
    const Lane multiplier = select(swap, pivot, below) * reciprocal;
    f.swapped[i] = swap;
    f.reciprocal[i] = reciprocal;
    f.lower[i] = multiplier;
    f.upper[i] = select(swap, next, beside);
    f.upper_second[i] = select(swap, after, broadcast(0.0));
    pivot = select(swap, beside, next) - multiplier * f.upper[i];
    beside = select(swap, -multiplier * after, after);
  }
  f.reciprocal[n - 1] = broadcast(1.0) / guarded(pivot);
  f.upper[n - 1] = f.upper_second[n - 1] = broadcast(0.0);
  return f;
}

inline void eliminate(const ShiftedFactor& f, int n, Lane* x) {
  Lane carried = x[0];
  for (int i = 0; i + 1 < n; ++i) {
    const Lane next = x[i + 1];
    const Lane kept = select(f.swapped[i], next, carried);
    carried = select(f.swapped[i], carried, next) - f.lower[i] * kept;
    x[i] = kept;
  }
  x[n - 1] = carried;
}

inline void substitute_back(const ShiftedFactor& f, int n, Lane* x) {
  Lane first = broadcast(0.0), second = broadcast(0.0);
  for (int i = n - 1; i >= 0; --i) {
    const Lane value = (x[i] - f.upper_second[i] * second - f.upper[i] * first) * f.reciprocal[i];
    x[i] = value;
    second = first;
    first = value;
  }
}

MOTTLE_INLINE Lane dot(const Lane* x, const Lane* y, int n) {
  Lane even = broadcast(0.0), odd = broadcast(0.0);
  int i = 0;
  for (; i + 1 < n; i += 2) {
    even += x[i] * y[i];
    odd += x[i + 1] * y[i + 1];
  }
  if (i < n) even += x[i] * y[i];
  return even + odd;
}

/// Scales to unit length, first by the largest entry so that the squares cannot overflow.
inline void normalise(Lane* x, int n) {
  Lane largest = broadcast(0.0);
  for (int i = 0; i < n; ++i) largest = larger(absolute(x[i]), largest);
  const Lane scale = broadcast(1.0) / largest;
  for (int i = 0; i < n; ++i) x[i] *= scale;
  const Lane reciprocal = broadcast(1.0) / square_root(dot(x, x, n));
  for (int i = 0; i < n; ++i) x[i] *= reciprocal;
}

/// Removes from a mode's vector its parts along the earlier modes of its cluster; an exact no-op in other lanes.
inline void orthogonalise(const Workspace& work, int n, int mode, Lane cluster_gap) {
  Lane* const x = work.vectors + static_cast<long>(mode) * n;
  Mask linked = ~Mask{};
  for (int other = mode - 1; other >= 0; --other) {
    linked &= work.values[other + 1] - work.values[other] < cluster_gap;
    if (!any(linked)) return;
    const Lane* const y = work.vectors + static_cast<long>(other) * n;
    const Lane part = select(linked, dot(x, y, n), broadcast(0.0));
    for (int i = 0; i < n; ++i) x[i] -= part * y[i];
  }
}

/// Fixed start vectors with no zero and no symmetry: entries in +-[0.5, 1) from a multiplicative sequence.
inline void start_vector(Lane* x, int n, int mode) {
  unsigned long long state = 0x9e3779b97f4a7c15ULL * static_cast<unsigned long long>(mode + 1);
  for (int i = 0; i < n; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double magnitude = 0.5 + static_cast<double>(state >> 34) * (0.5 / 1073741824.0);
    x[i] = broadcast((state >> 33 & 1U) != 0 ? magnitude : -magnitude);
  }
}

/// Largest entry of T z - lambda z.
inline Lane residual(const Workspace& work, int n, const Lane* z, Lane value) {
  Lane largest = broadcast(0.0), before = broadcast(0.0);
  for (int i = 0; i < n; ++i) {
    const Lane after = i + 1 < n ? work.offdiag[i] * z[i + 1] : broadcast(0.0);
    const Lane entry = absolute((work.diagonal[i] - value) * z[i] + before + after);
    largest = select(entry > largest, entry, largest);
    before = work.offdiag[i] * z[i];
  }
  return largest;
}

/// Fills work.vectors with orthonormal eigenvectors of T; returns the lanes in which every residual is small.
inline Mask iterate_vectors(const Workspace& work, int n, int modes, Lane bound) {
  constexpr int k_iterations = 3;         // one finds the vector unless the start was unlucky, two more polish
  const Lane cluster_gap = bound * 1e-3;  // vectors of more distant eigenvalues are orthogonal to about 1e-13
  const Lane tolerance = bound * 1e-13;
  Mask trusted = ~Mask{};
  for (int mode = 0; mode < modes; ++mode) {
    Lane* const x = work.vectors + static_cast<long>(mode) * n;
    const ShiftedFactor factor = factor_shifted(work, n, work.values[mode], bound * k_epsilon);
    start_vector(x, n, mode);
    for (int iteration = 0; iteration < k_iterations; ++iteration) {
      if (iteration > 0) eliminate(factor, n, x);
      substitute_back(factor, n, x);
      normalise(x, n);
      orthogonalise(work, n, mode, cluster_gap);
    }
    normalise(x, n);
    orthogonalise(work, n, mode, cluster_gap);
    normalise(x, n);
    trusted &= residual(work, n, x, work.values[mode]) <= tolerance;
  }
  return trusted;
}

}  // namespace
}  // namespace mottle::lane_kernels
