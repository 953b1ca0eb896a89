// Jacobi for every processor: 2 samples at a time.
#define MOTTLE_LANES 2
#include "linalg/batched/simd/jacobi.hpp"

namespace mottle::linalg::simd_kernels {
void jacobi_plain(const Problem& problem, const Output& output, long begin, long end) {
  dispatch<1>(problem, output, begin, end);
}
}  // namespace mottle::linalg::simd_kernels
