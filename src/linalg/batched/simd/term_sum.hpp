// Sums of a family's matrices with coefficients of each lane's sample.
#pragma once

#include "linalg/batched/simd/simd.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// result_e = constant_e + sum of coefficient(t) * term_t,e over `size` entries; terms go four at a time through
/// registers.
///
/// @param terms  the constant, and every `step` further a term
template <typename Coefficient>
MOTTLE_INLINE void sum_terms(const double* terms, long step, int count, const Coefficient& coefficient, long size,
                             Simd* result) {
  for (long e = 0; e < size; ++e) result[e] = broadcast(terms[e]);
  int term = 0;
  for (; term + 4 <= count; term += 4) {
    const double* const matrix = terms + (term + 1) * step;
    const Simd c0 = coefficient(term), c1 = coefficient(term + 1);
    const Simd c2 = coefficient(term + 2), c3 = coefficient(term + 3);
    for (long e = 0; e < size; ++e) {
      result[e] += c0 * matrix[e] + c1 * matrix[e + step] + c2 * matrix[e + 2 * step] + c3 * matrix[e + 3 * step];
    }
  }
  for (; term < count; ++term) {
    const double* const matrix = terms + (term + 1) * step;
    const Simd own = coefficient(term);
    for (long e = 0; e < size; ++e) result[e] += own * matrix[e];
  }
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
