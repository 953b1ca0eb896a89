// Where the arrays of one batch of larger pencils lie in the workspace; all entries are lanes.
#pragma once

#include "linalg/batched/lanes/lane.hpp"

namespace mottle::linalg::lane_kernels {
namespace {

/// Modes whose vectors are found side by side, see tridiagonal_vectors.hpp.
constexpr int k_vector_group = MOTTLE_VECTOR_GROUP;

/// Arrays of one batch. Lengths: packed triangles n(n+1)/2, the rest as said.
struct Workspace {
  Lane* matrix;     ///< packed; reflector k overwrites column k below the diagonal
  Lane* mass;       ///< packed Cholesky factor, or the diagonal [n]; unused if the mass is folded
  Lane* diagonal;   ///< [n] of the tridiagonal matrix
  Lane* offdiag;    ///< [n], entry i couples i and i + 1; the last is 0
  Lane* squares;    ///< [n], offdiag^2
  Lane* tau;        ///< [n], scale of each reflector
  Lane* update;     ///< [2][n]
  Lane* product;    ///< [n]
  Lane* low;        ///< [m] brackets of the eigenvalues
  Lane* high;       ///< [m]
  Lane* values;     ///< [m]
  Lane* vectors;    ///< [m][n]
  Lane* factor;     ///< [group][4 n] of shifted tridiagonal matrices
  Mask* swapped;    ///< [group][n], rows exchanged there
  Mask* count_low;  ///< [m] eigenvalues below each end of a bracket
  Mask* count_high;
  long total_lanes;

  Workspace(const Problem& problem, double* memory) {
    Lane* next = reinterpret_cast<Lane*>(memory);
    const long n = problem.order, m = problem.modes, packed = n * (n + 1) / 2;
    const auto take = [&next](long count) {
      Lane* const first = next;
      next += count;
      return first;
    };
    matrix = take(packed);
    mass = take(problem.mass_kind == MassKind::full ? packed : n);
    diagonal = take(n);
    offdiag = take(n);
    squares = take(n);
    tau = take(n);
    update = take(2 * n);
    product = take(n);
    low = take(m);
    high = take(m);
    values = take(m);
    vectors = take(problem.vectors ? m * n : 0);
    factor = take(k_vector_group * 4 * n);
    swapped = reinterpret_cast<Mask*>(take(k_vector_group * n));
    count_low = reinterpret_cast<Mask*>(take(m));
    count_high = reinterpret_cast<Mask*>(take(m));
    total_lanes = next - reinterpret_cast<Lane*>(memory);
  }
};

}  // namespace
}  // namespace mottle::linalg::lane_kernels
