// Arrays of one batch of pencils near a nominal one, and the sums of their terms. See davidson.hpp.
#pragma once

#include "linalg/batched/simd/tiles.hpp"
#include "linalg/batched/simd/workspace.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// What the block's vectors are like, by column.
struct BlockState {
  Simd* rayleigh;  ///< quotients
  Simd* lengths;   ///< y'My
  Simd* residual;  ///< squared
};

/// Arrays of one batch.
struct DavidsonWorkspace {
  Simd* stiffness;     ///< tiles
  Simd* mass;          ///< tiles; unused where it is constant, and diagonal
  Simd* coefficients;  ///< of the terms, stiffness and mass in turn
  Simd* tile;          ///< of a sketch
  Simd* reciprocals;   ///< [order] of the stiffness' diagonal
  Simd* masses;        ///< [order] the mass' diagonal
  Block y, ky, my;     ///< the block, K and M times it
  Block spare;
  Block elastic, inertial;  ///< W'K y and W'M y
  Simd *h, *g, *rotation;   ///< [block][block]: y'Ky, y'My and vectors of that pencil
  Simd* rest;               ///< [block][block]: see misses_none
  Simd* column;             ///< [order or sketch row], one of a block on its way out
  BlockState state;
  Simd alpha, beta;
  Workspace small;  ///< of the block's pencils
  long total_values;

  /// As Workspace.
  DavidsonWorkspace(const DavidsonProblem& problem, double* memory)
      : small(ritz_problem(problem), memory), total_values(small.total_values) {
    const auto take = [&](long count) {
      Simd* const first = memory == nullptr ? nullptr : reinterpret_cast<Simd*>(memory) + total_values;
      total_values += count;
      return first;
    };
    const long order = problem.order, block = problem.block;
    stiffness = take(tile_entries(problem));
    mass = take(problem.mass_terms > 0 ? tile_entries(problem) : 0);
    coefficients = take(problem.stiffness_terms + problem.mass_terms);
    tile = take(k_tile * k_tile);
    reciprocals = take(order);
    masses = take(order);
    y = ky = my = spare = {nullptr, problem.order, problem.block, problem.block};
    y.data = take(order * block);
    ky.data = take(order * block);
    my.data = take(order * block);
    spare.data = take(order * block);
    elastic = inertial = {nullptr, problem.sketch_rows, problem.block, problem.kept};
    elastic.data = take(problem.sketch_rows * block);
    inertial.data = take(problem.sketch_rows * block);
    h = take(block * block);
    g = take(block * block);
    rotation = take(block * block);
    rest = take(block * block);
    column = take(order > problem.sketch_rows ? order : problem.sketch_rows);
    state = {take(block), take(block), take(block)};
  }

  void set_columns(int columns) { y.columns = ky.columns = my.columns = columns; }

  static long tile_entries(const DavidsonProblem& problem) {
    const long tiles = problem.order / k_tile;
    return tiles * (tiles + 1) / 2 * k_tile * k_tile;
  }
  static Problem ritz_problem(const DavidsonProblem& problem) {
    Problem ritz;
    ritz.order = ritz.modes = problem.block;
    ritz.vectors = true;
    ritz.mass_kind = MassKind::full;
    return ritz;
  }
};

/// First row of the tile that holds row `block`: above it corrections are zero.
MOTTLE_INLINE int first_corrected_row(const DavidsonProblem& problem) {
  return problem.block / k_tile * k_tile;
}

inline void assemble_davidson(const DavidsonProblem& problem, const BatchSamples& batch, DavidsonWorkspace& work) {
  constexpr int k_entries = k_tile * k_tile;
  const int elastic = problem.stiffness_terms, inertial = problem.mass_terms;
  Simd* const coefficients = work.coefficients;
  for (int t = 0; t < elastic; ++t) {
    coefficients[t] = gather(problem.stiffness_coefficients, problem.stiffness_stride, t, batch);
  }
  for (int t = 0; t < inertial; ++t) {
    coefficients[elastic + t] = gather(problem.mass_coefficients, problem.mass_stride, t, batch);
  }
  for (long e = 0; e < DavidsonWorkspace::tile_entries(problem); e += k_entries) {
    combine_tile(problem.stiffness + e * (1 + elastic), elastic, coefficients, work.stiffness + e);
    if (inertial > 0) {
      combine_tile(problem.mass + e * (1 + inertial), inertial, coefficients + elastic, work.mass + e);
    }
  }
  for (int i = 0; i < problem.order; ++i) {
    work.reciprocals[i] = reciprocal(tile_entry(work.stiffness, problem.order, i, i));
    work.masses[i] = inertial > 0 ? tile_entry(work.mass, problem.order, i, i) : broadcast(problem.nominal_mass[i]);
  }
  work.alpha = gather(problem.ratios, 1, 0, batch);
  work.beta = gather(problem.mass_ratios, 1, 0, batch);
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
