// The lowest eigenvalues of a symmetric tridiagonal matrix, each lane by itself: sections by Sturm counts until the
// eigenvalues part, then Newton steps inside brackets that the counts certify.
#pragma once

#include "linalg/batched/simd/workspace.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Most eigenvalues treated side by side, so that their divisions overlap.
constexpr int k_bisect_group = 6;

/// What one pass down T - x says about x: the number of eigenvalues below, and Newton's step for det(T - x).
template <int Points>
struct Probe {
  Simd point[Points];
  Mask count[Points];
  Simd step[Points];
};

/// Pivots q_i of T - x = L D L' and their logarithmic derivatives t_i, by one division each:
///
///   q_i = d_i - x - s_i,   s_i = e_{i-1}^2 / q_{i-1},   t_i = q_i' / q_i = (s_i t_{i-1} - 1) / q_i
///   count = #(q_i < 0),    step = -1 / sum t_i
///
/// A pivot that is zero or hardly more counts as `least`, which is less than a rounding of T: the count stays right;
/// the step may become nan, which every comparison with a bracket refuses.
template <int Points>
inline void probe_spectrum(const Workspace& work, int n, Simd least, Probe<Points>& probe) {
  const Simd one = broadcast(1.0);
  const auto guarded = [&](Simd pivot) MOTTLE_FLAT { return select(absolute(pivot) < least, least, pivot); };
  Simd inverse[Points], rate[Points], sum[Points];
  for (int g = 0; g < Points; ++g) {
    const Simd pivot = guarded(work.diagonal[0] - probe.point[g]);
    probe.count[g] = -(pivot < broadcast(0.0));
    inverse[g] = reciprocal(pivot);
    sum[g] = rate[g] = -inverse[g];
  }
  for (int i = 1; i < n; ++i) {
    const Simd diagonal = work.diagonal[i], square = work.squares[i - 1];
    for (int g = 0; g < Points; ++g) {
      const Simd coupling = square * inverse[g];
      const Simd pivot = guarded(diagonal - probe.point[g] - coupling);
      probe.count[g] -= (pivot < broadcast(0.0));
      inverse[g] = reciprocal(pivot);
      rate[g] = (coupling * rate[g] - one) * inverse[g];
      sum[g] += rate[g];
    }
  }
  for (int g = 0; g < Points; ++g) probe.step[g] = -reciprocal(sum[g]);
}

/// Narrows the brackets of all modes from `from` on: Points common points a round across the group's brackets.
template <int Points>
inline void section(const Workspace& work, int n, int from, int modes, Simd least) {
  constexpr int k_rounds = 3;
  Probe<Points> probe;
  for (int round = 0; round < k_rounds; ++round) {
    const Simd low = work.low[from], width = (work.high[from + Points - 1] - low) * (1.0 / (Points + 1));
    for (int g = 0; g < Points; ++g) probe.point[g] = low + width * (g + 1.0);
    probe_spectrum<Points>(work, n, least, probe);
    for (int mode = from; mode < modes; ++mode) {
      for (int g = 0; g < Points; ++g) {
        const Mask above = probe.count[g] > Mask{} + mode;  // the mode's eigenvalue lies below the point
        const Mask lowers = above & (probe.point[g] < work.high[mode]);
        const Mask raises = ~above & (probe.point[g] > work.low[mode]);
        work.high[mode] = select(lowers, probe.point[g], work.high[mode]);
        work.count_high[mode] = lowers ? probe.count[g] : work.count_high[mode];
        work.low[mode] = select(raises, probe.point[g], work.low[mode]);
        work.count_low[mode] = raises ? probe.count[g] : work.count_low[mode];
      }
    }
  }
}

/// Error allowed in an eigenvalue at x: what the counts can resolve, where `rounding` is that of the numbers.
MOTTLE_INLINE Simd resolution(Simd x, Simd bound, double rounding) {
  return absolute(x) * (2.0 * rounding) + bound * (0.25 * rounding);
}

/// One bound on all eigenvalues, |lambda| <= bound (Gershgorin, a little enlarged).
inline Simd eigenvalue_bound(const Workspace& work, int n) {
  Simd bound = broadcast(0.0), before = broadcast(0.0);
  for (int i = 0; i < n; ++i) {
    const Simd after = absolute(work.offdiag[i]);
    const Simd sum = absolute(work.diagonal[i]) + before + after;
    bound = select(sum > bound, sum, bound);
    before = after;
  }
  return bound * (1.0 + 1e-12) + broadcast(k_tiny);
}

/// State of one mode's search beyond its bracket: where to probe next and how far past Newton's point to aim.
struct Search {
  Simd point;
  Simd overshoot;
};

/// Lanes in which the mode's eigenvalue has its bracket for itself.
MOTTLE_INLINE Mask holds_one(const Workspace& work, int mode) {
  return (work.count_low[mode] == Mask{} + mode) & (work.count_high[mode] == Mask{} + (mode + 1));
}

/// Takes in what a probe said about one mode and chooses the next point; lanes that are done keep every bit.
/// Returns the lanes whose bracket is still too wide.
///
/// Newton's point is moved a little on into the bracket, so that the next count closes it from the other side; the
/// move grows while rounding keeps that from happening. Where other eigenvalues share the bracket, or Newton's point
/// lies outside, the bracket is halved. Where the bracket holds one eigenvalue and no other is nearer than `margin`,
/// Newton's point errs by no more than n step^2 / margin: it is the eigenvalue once that is below the resolution.
MOTTLE_INLINE Mask narrow(const Workspace& work, int n, int mode, Mask count, Simd step, Simd bound, double rounding,
                          bool may_use_newton, Search& search) {
  const Simd point = search.point, fine = resolution(point, bound, rounding);
  Simd low = work.low[mode], high = work.high[mode];
  const Mask open = high - low > resolution(low, bound, rounding);
  const Mask was_isolated = holds_one(work, mode);
  const Simd margin = smaller(point - low, high - point);
  const Mask above = count > Mask{} + mode;
  const Mask lowers = open & above, raises = open & ~above;
  high = select(lowers, point, high);
  low = select(raises, point, low);
  work.count_high[mode] = lowers ? count : work.count_high[mode];
  work.count_low[mode] = raises ? count : work.count_low[mode];

  const Mask converged =
      open & was_isolated & (step * step * static_cast<double>(n) <= fine * margin) & (absolute(step) < margin);
  low = work.low[mode] = select(converged, point + step, low);
  high = work.high[mode] = select(converged, point + step, high);

  const Simd inward = select(above, broadcast(-1.0), broadcast(1.0));
  const Mask close = absolute(step) < fine * 32.0;
  const Simd advance = select(close, larger(step * inward, broadcast(0.0)), step * inward);
  const Simd newton = point + inward * (advance + search.overshoot);
  search.overshoot = select(close, search.overshoot * 4.0, search.overshoot);
  const Mask usable = holds_one(work, mode) & (newton > low) & (newton < high);
  const Simd middle = (low + high) * 0.5;
  search.point = may_use_newton ? select(usable, newton, middle) : middle;
  return high - low > resolution(low, bound, rounding);
}

/// Eigenvalues of modes [from, from + Count).
template <int Count>
inline void find_group(const Workspace& work, int n, int from, int modes, Simd bound, double rounding) {
  constexpr int k_newton_rounds = 40;  // isolation by halving comes out of these too
  constexpr int k_max_rounds = 100;    // 55 halvings close any bracket
  const Simd least = larger(bound * 1e-20, broadcast(k_tiny));
  section<Count>(work, n, from, modes, least);
  Probe<Count> probe;
  Search search[Count];
  for (int g = 0; g < Count; ++g) {
    search[g].point = (work.low[from + g] + work.high[from + g]) * 0.5;
    search[g].overshoot = resolution(search[g].point, bound, rounding) * 0.4;
  }
  for (int round = 0; round < k_max_rounds; ++round) {
    for (int g = 0; g < Count; ++g) probe.point[g] = search[g].point;
    probe_spectrum<Count>(work, n, least, probe);
    Mask open{};
    for (int g = 0; g < Count; ++g) {
      open |=
          narrow(work, n, from + g, probe.count[g], probe.step[g], bound, rounding, round < k_newton_rounds, search[g]);
    }
    if (!any(open)) break;
  }
  for (int mode = from; mode < from + Count; ++mode) {
    work.values[mode] = without_negative_zero((work.low[mode] + work.high[mode]) * 0.5);
  }
}

template <int Count>
inline void find_group_of(int count, const Workspace& work, int n, int from, int modes, Simd bound, double rounding) {
  if constexpr (Count > 0) {
    if (count == Count) return find_group<Count>(work, n, from, modes, bound, rounding);
    find_group_of<Count - 1>(count, work, n, from, modes, bound, rounding);
  }
}

/// Fills work.squares and work.values, ascending; each eigenvalue to about the error that T has anyway if its entries
/// are known to `rounding`.
inline void find_eigenvalues(const Workspace& work, int n, int modes, Simd bound, double rounding = k_epsilon) {
  for (int i = 0; i < n; ++i) work.squares[i] = work.offdiag[i] * work.offdiag[i];
  for (int mode = 0; mode < modes; ++mode) {
    work.low[mode] = -bound;
    work.high[mode] = bound;
    work.count_low[mode] = Mask{};
    work.count_high[mode] = Mask{} + n;
  }
  int groups = (modes + k_bisect_group - 1) / k_bisect_group;
  for (int from = 0; groups > 0; --groups) {
    const int count = (modes - from + groups - 1) / groups;  // groups of nearly equal size waste no probe
    find_group_of<k_bisect_group>(count, work, n, from, modes, bound, rounding);
    from += count;
  }
  for (int mode = 1; mode < modes; ++mode) {  // modes of a cluster, found apart, may have crossed by a rounding
    work.values[mode] = larger(work.values[mode], work.values[mode - 1]);
  }
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
