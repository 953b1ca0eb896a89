// Lowest modes of pencils near a nominal one in whose modes they are written: a block that begins with the nominal
// modes, corrections of its residuals by the diagonals (Davidson's), Rayleigh and Ritz at the end, and a count of the
// eigenvalues that shows that none is missed. See nearby_modes.hpp.
#pragma once

#include "linalg/lanes/nearby_workspace.hpp"
#include "linalg/lanes/solve.hpp"

namespace mottle::lane_kernels {
namespace {

/// Ritz vectors of the pencil in work.small's packed triangles, into work.turn [n][modes]; values in work.small.values.
inline Mask solve_ritz(const NearbyWorkspace& work, int n, int modes) {
  const Workspace& small = work.small;
  Mask trusted = factor_mass(small.mass, n);
  reduce_by_full_mass(small.matrix, small.mass, n);
  tridiagonalise(small, n);
  const Lane bound = eigenvalue_bound(small, n);
  trusted &= is_finite(bound * 4.0);
  find_eigenvalues(small, n, modes, bound);
  trusted &= iterate_vectors(small, n, modes, bound);
  transform_back(small, n, modes);
  solve_upper(small.mass, n, modes, small.vectors);
  for (int mode = 0; mode < modes; ++mode) {
    const Lane* const x = small.vectors + static_cast<long>(mode) * n;
    for (int i = 0; i < n; ++i) work.turn[static_cast<long>(i) * work.y.stride + mode] = x[i];
  }
  return trusted;
}

/// The block's first vectors: modes of the leading corner of the pencil.
inline Mask start_block(const NearbyProblem& problem, NearbyWorkspace& work) {
  const int n = problem.block;
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      const long entry = packed_index(n, i, j);
      work.small.matrix[entry] = tile_entry(work.stiffness, problem.order, i, j);
      work.small.mass[entry] = problem.mass_terms > 0 ? tile_entry(work.mass, problem.order, i, j)
                                                      : broadcast(i == j ? problem.nominal_mass[i] : 0.0);
    }
  }
  const Mask trusted = solve_ritz(work, n, n);
  work.set_columns(n);
  const long size = static_cast<long>(problem.order) * n;
  for (long entry = 0; entry < size; ++entry) {
    work.y.data[entry] = work.ky.data[entry] = work.my.data[entry] = broadcast(0.0);
  }
  for (long entry = 0; entry < static_cast<long>(n) * n; ++entry) work.y.data[entry] = work.turn[entry];
  return trusted;
}

/// ky += K change, my += M change; rows of `change` outside [from, to) are zero.
inline void add_products(const NearbyProblem& problem, const NearbyWorkspace& work, const Block& change, int from,
                         int to) {
  add_product(work.stiffness, change, from, to, work.ky);
  if (problem.mass_terms > 0) {
    add_product(work.mass, change, from, to, work.my);
    return;
  }
  for (int i = from; i < to; ++i) {
    for (int c = 0; c < change.columns; ++c) work.my.row(i)[c] += work.masses[i] * change.row(i)[c];
  }
}

/// Squared residuals of all columns from row `first` on.
inline void find_squares(const NearbyWorkspace& work, int first) {
  const BlockState& state = work.state;
  for (int c = 0; c < work.y.columns; ++c) state.residual[c] = broadcast(0.0);
  for (int i = first; i < work.y.rows; ++i) {
    const Lane *const ky = work.ky.row(i), *const my = work.my.row(i);
    for (int c = 0; c < work.y.columns; ++c) {
      const Lane r = ky[c] - state.rayleigh[c] * my[c];
      state.residual[c] += r * r;
    }
  }
}

inline void find_quotients(const NearbyWorkspace& work) {
  const BlockState& state = work.state;
  for (int c = 0; c < work.y.columns; ++c) state.rayleigh[c] = state.lengths[c] = broadcast(0.0);
  for (int i = 0; i < work.y.rows; ++i) {
    const Lane *const y = work.y.row(i), *const ky = work.ky.row(i), *const my = work.my.row(i);
    for (int c = 0; c < work.y.columns; ++c) {
      state.rayleigh[c] += y[c] * ky[c];
      state.lengths[c] += y[c] * my[c];
    }
  }
  for (int c = 0; c < work.y.columns; ++c) state.rayleigh[c] /= state.lengths[c];
}

/// Lanes in which the residuals of the sharp modes are below `share` of the limit.
inline Mask are_sharp(const NearbyProblem& problem, const NearbyWorkspace& work, double share) {
  Mask sharp = ~Mask{};
  for (int c = 0; c < problem.sharp; ++c) {
    const Lane mu = work.state.rayleigh[c] - problem.shift;
    sharp &= work.state.residual[c] <= mu * work.state.lengths[c] * work.alpha * (problem.limit * share);
  }
  return sharp;
}

/// y -= r / (k_ii - rayleigh m_ii) below the nominal modes' rows, in the lanes asked for, and the products with it.
///
///   1 / (1 - t) near (1 + t) (1 + t^2) (1 + t^4),   t = rayleigh m_ii / k_ii up to 1
inline void correct_block(const NearbyProblem& problem, const NearbyWorkspace& work, Mask lanes) {
  Block change = work.spare;
  change.columns = work.y.columns;
  const int from = first_corrected_row(problem);
  const Lane one = broadcast(1.0);
  for (int i = from; i < problem.order; ++i) {
    const Lane *const ky = work.ky.row(i), *const my = work.my.row(i);
    const Lane reciprocal = select(lanes, -work.reciprocals[i], broadcast(0.0));
    const Lane relative = work.masses[i] * work.reciprocals[i];
    for (int c = 0; c < change.columns; ++c) {
      const Lane rayleigh = work.state.rayleigh[c];
      const Lane t = smaller(rayleigh * relative, one), squared = t * t;
      const Lane inverse = reciprocal * (one + t) * (one + squared) * (one + squared * squared);
      const Lane step = i < problem.block ? broadcast(0.0) : (ky[c] - rayleigh * my[c]) * inverse;
      change.row(i)[c] = step;
      work.y.row(i)[c] += step;
    }
  }
  add_products(problem, work, change, from, problem.order);
}

/// Corrections until the sharp modes' residuals are small, the first of the whole block, the others of its first
/// vectors.
inline void correct_blocks(const NearbyProblem& problem, NearbyWorkspace& work) {
  constexpr int k_most = 6;
  constexpr double k_share = 0.25;  // the vectors of the block still couple
  for (int step = 0;; ++step) {
    find_quotients(work);
    find_squares(work, problem.block);
    const Mask open = ~are_sharp(problem, work, k_share);
    if (!any(open) || step == k_most) break;
    correct_block(problem, work, open);
    work.set_columns(problem.corrected);
  }
  work.set_columns(problem.block);
}

/// Rayleigh and Ritz: h, g, and values and vectors of their pencil.
inline Mask find_ritz(const NearbyProblem& problem, const NearbyWorkspace& work) {
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
  return solve_ritz(work, n, problem.kept);
}

/// Negative pivots of a packed symmetric matrix, eliminated in place; lanes with a pivot that tells nothing lose trust.
inline Mask count_negative(Lane* matrix, int n, Mask& trusted) {
  Mask count{};
  Lane scale = broadcast(0.0);
  for (int k = 0; k < n; ++k) scale = larger(scale, absolute(matrix[packed_index(n, k, k)]));
  for (int k = 0; k < n; ++k) {
    Lane* const column = matrix + packed_index(n, k, k) - k;
    count -= (column[k] < broadcast(0.0));
    trusted &= absolute(column[k]) > scale * 1e-10;
    const Lane reciprocal = broadcast(1.0) / column[k];
    for (int j = k + 1; j < n; ++j) {
      Lane* const target = matrix + packed_index(n, j, j) - j;
      const Lane multiplier = column[j] * reciprocal;
      for (int i = j; i < n; ++i) target[i] -= multiplier * column[i];
    }
  }
  return count;
}

/// Lanes in which no eigenvalue below the kept Ritz values is missed.
///
/// With S the block, R the rows of (K - x M) S below it and D a lower bound of K - x M there, the number of eigenvalues
/// below x is at most that of negative ones of S'(K - x M) S - R' D^-1 R: a congruence and a Schur complement. x lies
/// in the widest gap among the first Ritz values above the wanted ones.
///
///   D = alpha - (x - shift) beta m_i,   K(s) - shift M(s) >= alpha,   M(s) <= beta diag m
inline Mask misses_none(const NearbyProblem& problem, const NearbyWorkspace& work) {
  constexpr int k_gaps = 3;
  const int n = problem.block, modes = problem.modes;
  const Lane* const values = work.small.values;
  Lane widest = broadcast(-1.0), x = broadcast(0.0);
  Mask expected{};
  for (int p = modes; p < modes + k_gaps && p < problem.kept; ++p) {
    const Lane gap = (values[p] - values[p - 1]) / (values[p] - problem.shift);
    const Mask is_wider = gap > widest;
    widest = select(is_wider, gap, widest);
    x = select(is_wider, (values[p] + values[p - 1]) * 0.5, x);
    expected = is_wider ? Mask{} + p : expected;
  }
  Mask trusted = widest > broadcast(0.0);
  const Lane heavy = (x - problem.shift) * work.beta;
  Block rows = work.spare;
  rows.columns = n;
  for (int i = n; i < problem.order; ++i) {
    const Lane stiff = work.alpha - heavy * problem.nominal_mass[i];
    trusted &= stiff > work.alpha * 0.02;
    const Lane root = broadcast(1.0) / square_root(stiff);
    for (int c = 0; c < n; ++c) rows.row(i)[c] = (work.ky.row(i)[c] - x * work.my.row(i)[c]) * root;
  }
  make_gram(rows, rows, n, work.rest);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      const long from = static_cast<long>(i) * rows.stride + j;
      work.small.matrix[packed_index(n, i, j)] = work.h[from] - x * work.g[from] - work.rest[from];
    }
  }
  const Mask count = count_negative(work.small.matrix, n, trusted);
  return trusted & (count <= expected);
}

/// block <- block turn, and the spare one is where it was.
inline void turn_into_spare(const NearbyProblem& problem, NearbyWorkspace& work, Block& block) {
  const Block before = block;
  block = work.spare;
  block.columns = problem.kept;
  turn_block(before, work.turn, block);
  work.spare = before;
}

/// y <- y turn and so on; the Rayleigh quotients are the Ritz values.
inline void turn_blocks(const NearbyProblem& problem, NearbyWorkspace& work) {
  turn_into_spare(problem, work, work.y);
  turn_into_spare(problem, work, work.ky);
  turn_into_spare(problem, work, work.my);
  for (int c = 0; c < problem.kept; ++c) {
    work.state.rayleigh[c] = work.small.values[c];
    work.state.lengths[c] = broadcast(1.0);
  }
}

/// W'(K - lambda M) y of all kept modes, in work.elastic.
inline void sketch_residuals(const NearbyProblem& problem, const NearbyWorkspace& work) {
  const Lane* const masses = work.coefficients + problem.stiffness_terms;
  multiply_terms(problem.stiffness_sketch, problem.stiffness_terms, work.coefficients, work.y, work.tile, work.elastic);
  multiply_terms(problem.mass_sketch, problem.mass_terms, masses, work.y, work.tile, work.inertial);
  for (int i = 0; i < problem.sketch_rows; ++i) {
    for (int c = 0; c < problem.kept; ++c) work.elastic.row(i)[c] -= work.state.rayleigh[c] * work.inertial.row(i)[c];
  }
}

/// The first rows of a column of a block, with a sign.
MOTTLE_INLINE void store_column(const Block& block, int column, int rows, int lane, double sign, double* to) {
  for (int i = 0; i < rows; ++i) to[i] = sign * block.row(i)[column][lane];
}

/// The component of largest magnitude becomes positive.
inline void store_nearby(const NearbyProblem& problem, const Output& output, const BatchSamples& batch,
                         const NearbyWorkspace& work, Mask lanes) {
  if (!any(lanes)) return;
  sketch_residuals(problem, work);
  for (int mode = 0; mode < problem.modes; ++mode) {
    Lane largest = broadcast(0.0);
    for (int i = 0; i < problem.rows; ++i) {
      const Lane entry = work.y.row(i)[mode];
      largest = select(absolute(entry) > absolute(largest), entry, largest);
    }
    for (int lane = 0; lane < batch.count; ++lane) {
      if (lanes[lane] == 0) continue;
      const long place = batch.sample[lane] * problem.modes + mode;
      const double sign = largest[lane] < 0.0 ? -1.0 : 1.0;
      output.values[place] = work.small.values[mode][lane];
      store_column(work.y, mode, problem.rows, lane, sign, output.vectors + place * problem.rows);
      store_column(work.elastic, mode, problem.sketch_rows, lane, sign,
                   problem.sketched_residuals + place * problem.sketch_rows);
      output.trusted[batch.sample[lane]] = 1;
    }
  }
}

inline void solve_nearby_batch(const NearbyProblem& problem, const Output& output, const BatchSamples& batch,
                               NearbyWorkspace& work) {
  constexpr int k_most = 3;  // Ritz steps after the first
  assemble_nearby(problem, batch, work);
  Mask open = start_block(problem, work);  // lanes that are sound and not finished
  const int corner = (problem.block + k_tile - 1) / k_tile * k_tile;
  add_products(problem, work, work.y, 0, corner);
  correct_blocks(problem, work);
  for (int step = 0;; ++step) {
    open &= find_ritz(problem, work);
    if (step == 0) open &= misses_none(problem, work);
    turn_blocks(problem, work);
    find_squares(work, 0);
    const Mask sharp = are_sharp(problem, work, 1.0);
    store_nearby(problem, output, batch, work, open & sharp);
    open &= ~sharp;
    if (!any(open) || step == k_most) break;
    correct_block(problem, work, open);
  }
}

void solve_nearby(const NearbyProblem& problem, const Output& output, long begin, long end, double* memory) {
  NearbyWorkspace work(problem, memory);
  for (long first = begin; first < end; first += MOTTLE_LANES) {
    solve_nearby_batch(problem, output, batch_samples(first, end), work);
  }
}

long nearby_doubles(const NearbyProblem& problem) {
  return NearbyWorkspace(problem, nullptr).total_lanes * MOTTLE_LANES;
}

}  // namespace
}  // namespace mottle::lane_kernels
