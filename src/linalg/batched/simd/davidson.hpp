// Block Davidson iteration for pencils given in the modes of a nominal one: a block that begins with the nominal modes,
// diagonally scaled residuals as corrections, Rayleigh-Ritz at the end, and a count of the eigenvalues that proves that
// none is missed. See batched_davidson.hpp.
#pragma once

#include "linalg/batched/simd/davidson_ritz.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// The block's first vectors: approximate modes of the leading corner of the pencil. Their accuracy decides on the
/// number of corrections and on whether the count succeeds, not on its validity; find_ritz rejects what is not finite.
inline Mask start_block(const DavidsonProblem& problem, DavidsonWorkspace& work) {
  constexpr double k_rounding = 1e-8;
  const int n = problem.block;
  const Workspace& small = work.small;
  const Mask definite = take_corner(problem, work);
  solve_standard_form(small, n, n, n, k_rounding, 1);
  if (problem.mass_terms > 0) {
    solve_upper(small.mass, n, n, small.vectors);
  } else {
    for (long entry = 0; entry < static_cast<long>(n) * n; ++entry) small.vectors[entry] *= small.mass[entry % n];
  }
  take_vectors(work, n, n);
  work.set_columns(n);
  const long held = static_cast<long>(n) * n, size = static_cast<long>(problem.order) * n;
  for (long entry = 0; entry < held; ++entry) work.y.data[entry] = work.rotation[entry];
  for (long entry = held; entry < size; ++entry) work.y.data[entry] = broadcast(0.0);
  return definite;
}

/// ky += K change, my += M change, or = where they are new; rows of `change` outside [from, to) are zero, from = 0
/// where they are new.
template <bool IsNew = false>
inline void add_products(const DavidsonProblem& problem, const DavidsonWorkspace& work, const Block& change, int from,
                         int to) {
  add_product<IsNew>(work.stiffness, change, from, to, work.ky);
  if (problem.mass_terms > 0) {
    add_product<IsNew>(work.mass, change, from, to, work.my);
    return;
  }
  for (int i = from; i < (IsNew ? problem.order : to); ++i) {
    for (int c = 0; c < change.columns; ++c) {
      const Simd product = work.masses[i] * change.row(i)[c];
      work.my.row(i)[c] = IsNew ? product : work.my.row(i)[c] + product;
    }
  }
}

/// Squared residuals of all columns from row `first` on.
inline void find_squares(const DavidsonWorkspace& work, int first) {
  const BlockState& state = work.state;
  for (int from = 0; from < work.y.columns; from += k_block_columns) {
    Simd sums[k_block_columns], rayleigh[k_block_columns];
    for (int c = 0; c < k_block_columns; ++c) {
      sums[c] = broadcast(0.0);
      rayleigh[c] = state.rayleigh[from + c];
    }
    for (int i = first; i < work.y.rows; ++i) {
      const Simd *const ky = work.ky.row(i) + from, *const my = work.my.row(i) + from;
      for (int c = 0; c < k_block_columns; ++c) {
        const Simd r = ky[c] - rayleigh[c] * my[c];
        sums[c] += r * r;
      }
    }
    for (int c = 0; c < k_block_columns; ++c) state.residual[from + c] = sums[c];
  }
}

inline void find_quotients(const DavidsonWorkspace& work) {
  const BlockState& state = work.state;
  for (int from = 0; from < work.y.columns; from += k_block_columns) {
    Simd elastic[k_block_columns], inertial[k_block_columns];
    for (int c = 0; c < k_block_columns; ++c) elastic[c] = inertial[c] = broadcast(0.0);
    for (int i = 0; i < work.y.rows; ++i) {
      const Simd *const y = work.y.row(i) + from, *const ky = work.ky.row(i) + from, *const my = work.my.row(i) + from;
      for (int c = 0; c < k_block_columns; ++c) {
        elastic[c] += y[c] * ky[c];
        inertial[c] += y[c] * my[c];
      }
    }
    for (int c = 0; c < k_block_columns; ++c) {
      state.rayleigh[from + c] = elastic[c] * reciprocal(inertial[c]);
      state.lengths[from + c] = inertial[c];
    }
  }
}

/// Lanes in which the residuals of the first problem.converged modes are below `fraction` of the limit.
inline Mask are_converged(const DavidsonProblem& problem, const DavidsonWorkspace& work, double fraction) {
  Mask converged = ~Mask{};
  for (int c = 0; c < problem.converged; ++c) {
    const Simd size = larger(work.state.rayleigh[c], broadcast(problem.smallest));
    converged &= work.state.residual[c] <= size * work.state.lengths[c] * work.alpha * (problem.limit * fraction);
  }
  return converged;
}

/// y -= r / (k_ii - rayleigh m_ii) below the nominal modes' rows, in the lanes asked for, and the products with it.
///
///   1 / (1 - t) near (1 + t) (1 + t^2) (1 + t^4),   t = rayleigh m_ii / k_ii up to 1
inline void correct_block(const DavidsonProblem& problem, const DavidsonWorkspace& work, Mask lanes) {
  Block change = work.spare;
  change.columns = work.y.columns;
  const int from = first_corrected_row(problem);
  const Simd one = broadcast(1.0);
  for (int i = from; i < problem.order; ++i) {
    const Simd *const ky = work.ky.row(i), *const my = work.my.row(i);
    const Simd negative = select(lanes, -work.reciprocals[i], broadcast(0.0));
    const Simd relative = work.masses[i] * work.reciprocals[i];
    for (int c = 0; c < change.columns; ++c) {
      const Simd rayleigh = work.state.rayleigh[c];
      const Simd t = smaller(rayleigh * relative, one), squared = t * t;
      const Simd inverse = negative * (one + t) * (one + squared) * (one + squared * squared);
      const Simd step = i < problem.block ? broadcast(0.0) : (ky[c] - rayleigh * my[c]) * inverse;
      change.row(i)[c] = step;
      work.y.row(i)[c] += step;
    }
  }
  add_products(problem, work, change, from, problem.order);
}

/// Corrections until the residuals of the first problem.converged modes are small: one of all kept vectors, further
/// ones of the first problem.corrected.
inline void correct_blocks(const DavidsonProblem& problem, DavidsonWorkspace& work) {
  constexpr int k_max = 6;
  constexpr double k_fraction = 0.25;  // the vectors of the block still couple
  for (int step = 0;; ++step) {
    find_quotients(work);
    find_squares(work, problem.block);
    const Mask open = ~are_converged(problem, work, k_fraction);
    if (!any(open) || step == k_max) break;
    if (step == 0) work.set_columns(problem.kept);
    correct_block(problem, work, open);
    work.set_columns(problem.corrected);
  }
  work.set_columns(problem.block);
}

/// block <- block rotation, written to the spare block's memory; the two exchange memory.
inline void rotate_into_spare(const DavidsonProblem& problem, DavidsonWorkspace& work, Block& block) {
  const Block before = block;
  block = work.spare;
  block.columns = problem.kept;
  rotate_block(before, work.rotation, block);
  work.spare = before;
}

/// y <- y rotation, also of K y and M y; the Rayleigh quotients are the Ritz values.
inline void rotate_blocks(const DavidsonProblem& problem, DavidsonWorkspace& work) {
  rotate_into_spare(problem, work, work.y);
  rotate_into_spare(problem, work, work.ky);
  rotate_into_spare(problem, work, work.my);
  for (int c = 0; c < problem.kept; ++c) {
    work.state.rayleigh[c] = work.small.values[c];
    work.state.lengths[c] = broadcast(1.0);
  }
}

/// W'(K - lambda M) y of all kept modes, in work.elastic.
inline void sketch_residuals(const DavidsonProblem& problem, const DavidsonWorkspace& work) {
  const Simd* const masses = work.coefficients + problem.stiffness_terms;
  multiply_terms(problem.stiffness_sketch, problem.stiffness_terms, work.coefficients, work.y, work.tile, work.elastic);
  multiply_terms(problem.mass_sketch, problem.mass_terms, masses, work.y, work.tile, work.inertial);
  for (int i = 0; i < problem.sketch_rows; ++i) {
    for (int c = 0; c < problem.kept; ++c) work.elastic.row(i)[c] -= work.state.rayleigh[c] * work.inertial.row(i)[c];
  }
}

/// Stores the first rows of a column of a block, with signs, for the sample of each lane.
///
/// @param to      address of the first sample; `stride` from one sample to the next
/// @param column  memory for the column: its rows are far apart in the block, and lanes are stored one by one
inline void store_column(const Block& block, int mode, int rows, Mask signs, Mask lanes, const BatchSamples& batch,
                         double* to, long stride, Simd* column) {
  for (int i = 0; i < rows; ++i) column[i] = flip_sign(block.row(i)[mode], signs);
  for (int lane = 0; lane < batch.count; ++lane) {
    if (lanes[lane] == 0) continue;
    double* const own = to + batch.sample[lane] * stride;
    for (int i = 0; i < rows; ++i) own[i] = column[i][lane];
  }
}

/// The component of largest magnitude becomes positive.
inline void store_davidson(const DavidsonProblem& problem, const Output& output, const BatchSamples& batch,
                           const DavidsonWorkspace& work, Mask lanes) {
  if (!any(lanes)) return;
  sketch_residuals(problem, work);
  for (int mode = 0; mode < problem.modes; ++mode) {
    Simd largest = broadcast(0.0);
    for (int i = 0; i < problem.rows; ++i) {
      const Simd entry = work.y.row(i)[mode];
      largest = select(absolute(entry) > absolute(largest), entry, largest);
    }
    const Mask signs = sign_bits(largest);
    const long rows = problem.rows, sketched = problem.sketch_rows;
    store_column(work.y, mode, problem.rows, signs, lanes, batch, output.vectors + mode * rows, problem.modes * rows,
                 work.column);
    store_column(work.elastic, mode, problem.sketch_rows, signs, lanes, batch,
                 problem.sketched_residuals + mode * sketched, problem.modes * sketched, work.column);
  }
  for (int lane = 0; lane < batch.count; ++lane) {
    if (lanes[lane] == 0) continue;
    double* const values = output.values + batch.sample[lane] * problem.modes;
    for (int mode = 0; mode < problem.modes; ++mode) values[mode] = work.small.values[mode][lane];
    output.valid[batch.sample[lane]] = 1;
  }
}

inline void solve_davidson_batch(const DavidsonProblem& problem, const Output& output, const BatchSamples& batch,
                                 DavidsonWorkspace& work) {
  constexpr int k_max = 3;  // Ritz steps after the first
  assemble_davidson(problem, batch, work);
  Mask open = start_block(problem, work);  // lanes that are sound and not finished
  const int corner = (problem.block + k_tile - 1) / k_tile * k_tile;
  add_products<true>(problem, work, work.y, 0, corner);
  correct_blocks(problem, work);
  for (int step = 0;; ++step) {
    open &= find_ritz(problem, work);
    if (step == 0) open &= misses_none(problem, work);
    rotate_blocks(problem, work);
    find_squares(work, 0);
    const Mask converged = are_converged(problem, work, 1.0);
    store_davidson(problem, output, batch, work, open & converged);
    open &= ~converged;
    if (!any(open) || step == k_max) break;
    correct_block(problem, work, open);
  }
}

void solve_davidson(const DavidsonProblem& problem, const Output& output, long begin, long end, double* memory) {
  DavidsonWorkspace work(problem, memory);
  for (long first = begin; first < end; first += MOTTLE_LANES) {
    solve_davidson_batch(problem, output, batch_samples(first, end), work);
  }
}

long davidson_doubles(const DavidsonProblem& problem) {
  return DavidsonWorkspace(problem, nullptr).total_values * MOTTLE_LANES;
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
