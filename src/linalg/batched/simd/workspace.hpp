// Layout of one batch's arrays in the workspace, for pencils of more than 8 degrees of freedom; all entries are Simd.
#pragma once

#include "linalg/batched/simd/simd.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Modes whose vectors are found side by side, see tridiagonal_vectors.hpp.
constexpr int k_vector_group = MOTTLE_VECTOR_GROUP;

/// Arrays of one batch. Lengths: packed triangles n(n+1)/2, the rest as said.
struct Workspace {
  Simd* matrix;     ///< packed; reflector k overwrites column k below the diagonal
  Simd* mass;       ///< packed Cholesky factor, or the diagonal [n]; unused if the mass is folded
  Simd* diagonal;   ///< [n] of the tridiagonal matrix
  Simd* offdiag;    ///< [n], entry i couples i and i + 1; the last is 0
  Simd* squares;    ///< [n], offdiag^2
  Simd* tau;        ///< [n], scale of each reflector
  Simd* update;     ///< [2][n]
  Simd* product;    ///< [n]
  Simd* low;        ///< [m] brackets of the eigenvalues
  Simd* high;       ///< [m]
  Simd* values;     ///< [m]
  Simd* vectors;    ///< [m][n]
  Simd* factor;     ///< [group][4 n] of shifted tridiagonal matrices
  Mask* swapped;    ///< [group][n], rows exchanged there
  Mask* count_low;  ///< [m] eigenvalues below each end of a bracket
  Mask* count_high;
  long total_values = 0;

  /// In memory of at least total_values; without memory only these are counted.
  Workspace(const Problem& problem, double* memory) {
    const long n = problem.order, m = problem.modes, packed = n * (n + 1) / 2;
    const auto take = [&](long count) {
      Simd* const first = memory == nullptr ? nullptr : reinterpret_cast<Simd*>(memory) + total_values;
      total_values += count;
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
  }
};

}  // namespace
}  // namespace mottle::linalg::simd_kernels
