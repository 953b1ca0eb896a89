// Pencils of up to 8 degrees of freedom by cyclic Jacobi, unrolled, one sample a lane. Included by one file per
// register width, which sets MOTTLE_LANES.
#pragma once

#include "linalg/batched/simd/small_pencil.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Order of the N(N-1)/2 rotations of a sweep: rounds of disjoint pairs (round-robin tournament), so that the
/// divisions and square roots of one round overlap in the pipeline.
template <int N>
struct Tournament {
  static constexpr int k_pairs = N * (N - 1) / 2;
  int first[k_pairs + 1] = {};
  int second[k_pairs + 1] = {};

  constexpr Tournament() {
    const int players = N + N % 2;
    int next = 0;
    for (int round = 0; round < players - 1; ++round) {
      for (int table = 0; table < players / 2; ++table) {
        const int a = table == 0 ? players - 1 : (round + table) % (players - 1);
        const int b = (round + players - 1 - table) % (players - 1);
        if (a >= N || b >= N) continue;
        first[next] = a < b ? a : b;
        second[next] = a < b ? b : a;
        ++next;
      }
    }
  }
};

/// Lanes in which an off-diagonal entry still matters. The first bound keeps small eigenvalues of graded matrices
/// to relative accuracy; the second ends the iteration where an eigenvalue is zero.
template <int N>
MOTTLE_INLINE Mask unconverged_lanes(const SmallPencil<N>& pencil, Simd floor) {
  using Pencil = SmallPencil<N>;
  Mask open{};
  unrolled<1, N>([&](auto row) MOTTLE_FLAT {
    unrolled<0, row.value>([&](auto column) MOTTLE_FLAT {
      constexpr int i = row.value, j = column.value;
      const Simd entry = pencil.matrix[Pencil::index(i, j)];
      const Simd scale = absolute(pencil.matrix[Pencil::index(i, i)] * pencil.matrix[Pencil::index(j, j)]);
      open |= entry * entry > larger(scale * 1e-34, floor);
    });
  });
  return open;
}

/// Rotates rows and columns p and q so that entry (p, q) vanishes; lanes outside `active` keep every bit.
///
///   h = a_qq - a_pp,  b = 2 a_pq,  w = |h| + sqrt(h^2 + b^2),  (c, s) = (w, sgn(h) b) / sqrt(w^2 + b^2)
template <int N, bool Vectors, int P, int Q>
MOTTLE_INLINE void rotate(SmallPencil<N>& pencil, Mask active) {
  using Pencil = SmallPencil<N>;
  Simd* a = pencil.matrix;
  const Simd pivot = a[Pencil::index(P, Q)];
  const Simd h = a[Pencil::index(Q, Q)] - a[Pencil::index(P, P)];
  const Simd b = flip_sign(pivot + pivot, sign_bits(h));
  const Simd w = absolute(h) + positive_root(h * h + b * b);
  const Simd length_squared = w * w + b * b;
  const Mask rotates = active & (length_squared > broadcast(0.0));
  const Simd scale = reciprocal_root(length_squared);
  const Simd c = select(rotates, w * scale, broadcast(1.0));
  const Simd s = select(rotates, b * scale, broadcast(0.0));
  const Simd shift = select(rotates, quotient(b, w, reciprocal(w)) * pivot, broadcast(0.0));

  a[Pencil::index(P, P)] -= shift;
  a[Pencil::index(Q, Q)] += shift;
  a[Pencil::index(P, Q)] = select(rotates, broadcast(0.0), pivot);
  unrolled<0, N>([&](auto row) MOTTLE_FLAT {
    constexpr int r = row.value;
    if constexpr (r != P && r != Q) {
      const Simd x = a[Pencil::index(r, P)], y = a[Pencil::index(r, Q)];
      a[Pencil::index(r, P)] = c * x - s * y;
      a[Pencil::index(r, Q)] = c * y + s * x;
    }
    if constexpr (Vectors) {
      const Simd x = pencil.columns[P][r], y = pencil.columns[Q][r];
      pencil.columns[P][r] = c * x - s * y;
      pencil.columns[Q][r] = c * y + s * x;
    }
  });
}

/// Batches rotated side by side: with few pairs in a round a rotation waits for the one before, and another batch fills
/// the wait; as many as the registers hold, or little more.
template <int N, bool Vectors>
constexpr int k_batches = MOTTLE_LANES == 8 && N <= 3 ? (Vectors ? 3 : 4)
                          : N <= 4                    ? 2
                                                      : 1;

/// Diagonalises; each lane stops by its own criterion, so extra sweeps for a neighbour change nothing.
template <int N, bool Vectors, int Batches>
MOTTLE_INLINE void diagonalise(SmallPencil<N> (&pencils)[Batches]) {
  constexpr int k_max_sweeps = 20;
  static constexpr Tournament<N> k_order;
  Simd squares[Batches], floor[Batches];
  Mask active[Batches], open{};
  for (int b = 0; b < Batches; ++b) {
    squares[b] = broadcast(0.0);
    unrolled<0, N*(N + 1) / 2>(
        [&](auto entry) MOTTLE_FLAT { squares[b] += pencils[b].matrix[entry.value] * pencils[b].matrix[entry.value]; });
    floor[b] = squares[b] * 1e-52;
    active[b] = unconverged_lanes<N>(pencils[b], floor[b]);
    open |= active[b];
  }
  for (int sweep = 0; sweep < k_max_sweeps && any(open); ++sweep) {
    unrolled<0, N*(N - 1) / 2>([&](auto pair) MOTTLE_FLAT {
      unrolled<0, Batches>([&](auto b) MOTTLE_FLAT {
        rotate<N, Vectors, k_order.first[pair.value], k_order.second[pair.value]>(pencils[b.value], active[b.value]);
      });
    });
    open = Mask{};
    for (int b = 0; b < Batches; ++b) {
      active[b] &= unconverged_lanes<N>(pencils[b], floor[b]);
      open |= active[b];
    }
  }
  for (int b = 0; b < Batches; ++b) pencils[b].valid &= ~active[b] & is_finite(squares[b]);
}

/// Puts the diagonal, and the columns with it, into ascending order.
template <int N, bool Vectors>
MOTTLE_INLINE void sort_ascending(SmallPencil<N>& pencil, Simd (&values)[N]) {
  unrolled<0, N>([&](auto i) MOTTLE_FLAT { values[i.value] = pencil.matrix[SmallPencil<N>::index(i.value, i.value)]; });
  unrolled<0, N - 1>([&](auto pass) MOTTLE_FLAT {
    unrolled<0, N - 1 - pass.value>([&](auto place) MOTTLE_FLAT {
      constexpr int i = place.value, j = place.value + 1;
      const Mask swap = values[j] < values[i];
      const Simd low = select(swap, values[j], values[i]);
      values[j] = select(swap, values[i], values[j]);
      values[i] = low;
      if constexpr (Vectors) {
        unrolled<0, N>([&](auto row) MOTTLE_FLAT {
          const Simd x = pencil.columns[i][row.value], y = pencil.columns[j][row.value];
          pencil.columns[i][row.value] = select(swap, y, x);
          pencil.columns[j][row.value] = select(swap, x, y);
        });
      }
    });
  });
}

template <int N>
MOTTLE_INLINE void make_largest_component_positive(Simd (&column)[N]) {
  Simd largest = column[0];
  unrolled<1, N>([&](auto row) MOTTLE_FLAT {
    largest = select(absolute(column[row.value]) > absolute(largest), column[row.value], largest);
  });
  const Mask sign = sign_bits(largest);
  unrolled<0, N>([&](auto row)
                     MOTTLE_FLAT { column[row.value] = without_negative_zero(flip_sign(column[row.value], sign)); });
}

template <int N>
MOTTLE_INLINE void load(const Problem& problem, const BatchSamples& batch, SmallPencil<N>& pencil) {
  constexpr int k_packed = N * (N + 1) / 2;
  pencil.valid = ~Mask{};
  combine<k_packed>(problem.stiffness, problem.stiffness_terms, problem.stiffness_coefficients,
                    problem.stiffness_stride, batch, pencil.matrix);
  if (problem.mass_kind == MassKind::full) {
    Simd mass[k_packed];
    combine<k_packed>(problem.mass, problem.mass_terms, problem.mass_coefficients, problem.mass_stride, batch, mass);
    reduce_to_standard_form<N>(mass, pencil);
    return;
  }
  // Started from L^-T instead of the identity, the product of the rotations is the M-normalised modes themselves.
  unrolled<0, N>([&](auto row) MOTTLE_FLAT {
    unrolled<0, N>([&](auto column) MOTTLE_FLAT {
      constexpr int i = row.value, j = column.value;
      pencil.columns[j][i] = broadcast(problem.back_transform[j * N + i]);
    });
  });
}

template <int N, bool Vectors>
MOTTLE_INLINE void store(const Problem& problem, const Output& output, const BatchSamples& batch,
                         SmallPencil<N>& pencil, const Simd (&values)[N]) {
  Simd columns[N * N];
  Mask valid = pencil.valid;
  unrolled<0, N>([&](auto mode) MOTTLE_FLAT {
    valid &= is_finite(values[mode.value]);
    if constexpr (Vectors) {
      make_largest_component_positive<N>(pencil.columns[mode.value]);
      unrolled<0, N>([&](auto row)
                         MOTTLE_FLAT { columns[mode.value * N + row.value] = pencil.columns[mode.value][row.value]; });
    }
  });
  const int length = N * problem.modes;
  for (int lane = 0; lane < batch.count; ++lane) {
    const long sample = batch.sample[lane];
    output.valid[sample] = valid[lane] != 0;
    double* value = output.values + sample * problem.modes;
    for (int mode = 0; mode < problem.modes; ++mode) value[mode] = values[mode][lane];
    if constexpr (Vectors) {
      double* vector = output.vectors + sample * length;
      for (int entry = 0; entry < length; ++entry) vector[entry] = columns[entry][lane];
    }
  }
}

/// Solves the samples from `first` on, Batches registers of them.
template <int N, bool Vectors, int Batches>
MOTTLE_INLINE void solve_together(const Problem& problem, const Output& output, long first, long end) {
  BatchSamples batches[Batches];
  SmallPencil<N> pencils[Batches];
  for (int b = 0; b < Batches; ++b) {
    batches[b] = batch_samples(first + static_cast<long>(b) * MOTTLE_LANES, end);
    load<N>(problem, batches[b], pencils[b]);
  }
  diagonalise<N, Vectors, Batches>(pencils);
  for (int b = 0; b < Batches; ++b) {
    Simd values[N];
    sort_ascending<N, Vectors>(pencils[b], values);
    unrolled<0, N>([&](auto i) MOTTLE_FLAT { values[i.value] = without_negative_zero(values[i.value]); });
    store<N, Vectors>(problem, output, batches[b], pencils[b], values);
  }
}

template <int N, bool Vectors>
void solve_small(const Problem& problem, const Output& output, long begin, long end) {
  // Always as many together, if need be with copies of the last sample: other code might round otherwise.
  constexpr long k_together = static_cast<long>(k_batches<N, Vectors>) * MOTTLE_LANES;
  for (long first = begin; first < end; first += k_together) {
    solve_together<N, Vectors, k_batches<N, Vectors>>(problem, output, first, end);
  }
}

template <int N>
void dispatch(const Problem& problem, const Output& output, long begin, long end) {
  if constexpr (N <= k_jacobi_limit) {
    if (problem.order != N) return dispatch<N + 1>(problem, output, begin, end);
    if (problem.vectors) return solve_small<N, true>(problem, output, begin, end);
    solve_small<N, false>(problem, output, begin, end);
  }
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
