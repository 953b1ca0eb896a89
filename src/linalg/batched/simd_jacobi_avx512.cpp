// Jacobi for processors with AVX-512: 8 samples at a time. Compiled with those flags, see simd_flags.cmake.
#if defined(__x86_64__)
#define MOTTLE_LANES 8
#include "linalg/batched/simd/jacobi.hpp"

namespace mottle::linalg::simd_kernels {
void jacobi_avx512(const Problem& problem, const Output& output, long begin, long end) {
  dispatch<1>(problem, output, begin, end);
}
}  // namespace mottle::linalg::simd_kernels
#endif
