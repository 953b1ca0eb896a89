// The reciprocals and roots of the AVX-512 kernels, for simd_roots_test.cpp: compiled with those flags.
#pragma once

namespace mottle::linalg_test {

/// 1 / x, y / x, sqrt(x) and 1 / sqrt(x) of eight x.
void simd_roots_avx512(const double* x, const double* y, double* reciprocal, double* quotient, double* root,
                       double* reciprocal_root);

}  // namespace mottle::linalg_test
