// Reciprocals and roots by estimates against the processor's own division and root, which round correctly.
#include "linalg/simd_roots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mottle/linalg/batched/batch_eigen.hpp"

namespace mottle::linalg {
namespace {

#if defined(__x86_64__)
TEST(SimdRoots, AreThoseOfTheProcessorToTheLastBit) {
  if (!is_simd_level_available(SimdLevel::avx512)) GTEST_SKIP() << "this processor has no AVX-512";
  constexpr int k_lanes = 8, k_batches = 250'000;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(1.0, 2.0);
  std::uniform_int_distribution<int> exponent(-400, 400);
  int others = 0;
  for (int batch = 0; batch < k_batches; ++batch) {
    double x[k_lanes], y[k_lanes], reciprocal[k_lanes], quotient[k_lanes], root[k_lanes], reciprocal_root[k_lanes];
    for (int lane = 0; lane < k_lanes; ++lane) {
      x[lane] = std::ldexp(mantissa(random), exponent(random));
      y[lane] = std::ldexp(mantissa(random), exponent(random));
    }
    linalg_test::simd_roots_avx512(x, y, reciprocal, quotient, root, reciprocal_root);
    for (int lane = 0; lane < k_lanes; ++lane) {
      const double own = std::sqrt(x[lane]);
      others += static_cast<int>(reciprocal[lane] != 1.0 / x[lane]) +
                static_cast<int>(quotient[lane] != y[lane] / x[lane]) + static_cast<int>(root[lane] != own) +
                static_cast<int>(reciprocal_root[lane] != 1.0 / own);
    }
  }
  EXPECT_EQ(others, 0);
}

TEST(SimdRoots, EndOneBitLowForAMantissaOfOnes) {
  if (!is_simd_level_available(SimdLevel::avx512)) GTEST_SKIP() << "this processor has no AVX-512";
  double x[8], reciprocal[8], quotient[8], root[8], reciprocal_root[8];
  for (double& value : x) value = 1.0 - 0x1p-53;
  linalg_test::simd_roots_avx512(x, x, reciprocal, quotient, root, reciprocal_root);
  EXPECT_EQ(reciprocal[0], 1.0);  // 1 + 2^-53 and a little, which a division rounds up
  EXPECT_EQ(quotient[0], 1.0);
  EXPECT_EQ(root[0], std::sqrt(x[0]));
  EXPECT_EQ(reciprocal_root[0], 1.0);
}
#endif

}  // namespace
}  // namespace mottle::linalg
