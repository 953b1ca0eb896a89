#include "linalg/simd_roots.hpp"

#define MOTTLE_LANES 8
#include "linalg/batched/simd/unaligned.hpp"

void mottle::linalg_test::simd_roots_avx512(const double* x, const double* y, double* reciprocal, double* quotient,
                                            double* root, double* reciprocal_root) {
  namespace lanes = mottle::linalg::simd_kernels;
  const lanes::Simd own = lanes::load(x), inverse = lanes::reciprocal(own);
  lanes::store(reciprocal, inverse);
  lanes::store(quotient, lanes::quotient(lanes::load(y), own, inverse));
  lanes::store(root, lanes::positive_root(own));
  lanes::store(reciprocal_root, lanes::reciprocal_root(own));
}
