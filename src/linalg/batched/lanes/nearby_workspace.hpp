// Arrays of one batch of pencils near a nominal one, and the sums of their terms. See nearby.hpp.
#pragma once

#include "linalg/batched/lanes/tiles.hpp"
#include "linalg/batched/lanes/workspace.hpp"

namespace mottle::linalg::lane_kernels {
namespace {

/// What the block's vectors are like, by column.
struct BlockState {
  Lane* rayleigh;  ///< quotients
  Lane* lengths;   ///< y'My
  Lane* residual;  ///< squared
};

/// Arrays of one batch.
struct NearbyWorkspace {
  Lane* stiffness;     ///< tiles
  Lane* mass;          ///< tiles; unused where it is constant, and diagonal
  Lane* coefficients;  ///< of the terms, stiffness and mass in turn
  Lane* tile;          ///< of a sketch
  Lane* reciprocals;   ///< [order] of the stiffness' diagonal
  Lane* masses;        ///< [order] the mass' diagonal
  Block y, ky, my;     ///< the block, K and M times it
  Block spare;
  Block elastic, inertial;  ///< W'K y and W'M y
  Lane *h, *g, *turn;       ///< [block][block]: y'Ky, y'My and vectors of that pencil
  Lane* rest;               ///< [block][block]: see misses_none
  Lane* column;             ///< [order or sketch row], one of a block on its way out
  BlockState state;
  Lane alpha, beta;
  Workspace small;  ///< of the block's pencils
  long total_lanes;

  NearbyWorkspace(const NearbyProblem& problem, double* memory)
      : small(ritz_problem(problem), memory), total_lanes(small.total_lanes) {
    const auto take = [&](long count) {
      Lane* const first = reinterpret_cast<Lane*>(memory) + total_lanes;
      total_lanes += count;
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
    turn = take(block * block);
    rest = take(block * block);
    column = take(order > problem.sketch_rows ? order : problem.sketch_rows);
    state = {take(block), take(block), take(block)};
  }

  void set_columns(int columns) { y.columns = ky.columns = my.columns = columns; }

  static long tile_entries(const NearbyProblem& problem) {
    const long tiles = problem.order / k_tile;
    return tiles * (tiles + 1) / 2 * k_tile * k_tile;
  }
  static Problem ritz_problem(const NearbyProblem& problem) {
    Problem ritz;
    ritz.order = ritz.modes = problem.block;
    ritz.vectors = true;
    ritz.mass_kind = MassKind::full;
    return ritz;
  }
};

/// First row of the tile that holds row `block`: above it corrections are zero.
MOTTLE_INLINE int first_corrected_row(const NearbyProblem& problem) {
  return problem.block / k_tile * k_tile;
}

inline void assemble_nearby(const NearbyProblem& problem, const BatchSamples& batch, NearbyWorkspace& work) {
  constexpr int k_entries = k_tile * k_tile;
  const int elastic = problem.stiffness_terms, inertial = problem.mass_terms;
  Lane* const coefficients = work.coefficients;
  for (int t = 0; t < elastic; ++t) {
    coefficients[t] = gather(problem.stiffness_coefficients, problem.stiffness_stride, t, batch);
  }
  for (int t = 0; t < inertial; ++t) {
    coefficients[elastic + t] = gather(problem.mass_coefficients, problem.mass_stride, t, batch);
  }
  for (long e = 0; e < NearbyWorkspace::tile_entries(problem); e += k_entries) {
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
  work.beta = gather(problem.heavier, 1, 0, batch);
}

}  // namespace
}  // namespace mottle::linalg::lane_kernels
