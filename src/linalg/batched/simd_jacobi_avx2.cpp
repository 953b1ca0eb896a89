// Jacobi for processors with AVX2 and FMA: 4 samples at a time. Compiled with those flags, see simd_flags.cmake.
#if defined(__x86_64__)
#define MOTTLE_LANES 4
#include "linalg/batched/simd/jacobi.hpp"

namespace mottle::linalg::simd_kernels {
void jacobi_avx2(const Problem& problem, const Output& output, long begin, long end) {
  dispatch<1>(problem, output, begin, end);
}
}  // namespace mottle::linalg::simd_kernels
#endif
