// Sums of a family's terms with a coefficient in each lane.
#pragma once

#include "linalg/batched/lanes/lane.hpp"

namespace mottle::linalg::lane_kernels {
namespace {

/// result_e = constant_e + sum of coefficient(t) * term_t,e over `size` entries; terms go four at a time through
/// registers.
///
/// @param terms  the constant, and every `step` further a term
template <typename Coefficient>
MOTTLE_INLINE void sum_terms(const double* terms, long step, int count, const Coefficient& coefficient, long size,
                             Lane* result) {
  for (long e = 0; e < size; ++e) result[e] = broadcast(terms[e]);
  int term = 0;
  for (; term + 4 <= count; term += 4) {
    const double* const matrix = terms + (term + 1) * step;
    const Lane c0 = coefficient(term), c1 = coefficient(term + 1);
    const Lane c2 = coefficient(term + 2), c3 = coefficient(term + 3);
    for (long e = 0; e < size; ++e) {
      result[e] += c0 * matrix[e] + c1 * matrix[e + step] + c2 * matrix[e + 2 * step] + c3 * matrix[e + 3 * step];
    }
  }
  for (; term < count; ++term) {
    const double* const matrix = terms + (term + 1) * step;
    const Lane own = coefficient(term);
    for (long e = 0; e < size; ++e) result[e] += own * matrix[e];
  }
}

}  // namespace
}  // namespace mottle::linalg::lane_kernels
