// The SIMD vector type Simd, one double of each of several samples, and the operations that the kernels need.
// Everything in simd/ has internal linkage and uses nothing of std or Eigen: the file is compiled with instructions
// that other files must not inherit. Every operation treats each lane alone, so a sample's bits do not depend on its
// neighbours.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "linalg/batched/simd_kernels.hpp"

#define MOTTLE_INLINE inline __attribute__((always_inline))
#define MOTTLE_FLAT __attribute__((always_inline))  // for lambdas

namespace mottle::linalg::simd_kernels {
namespace {

/// One register: lane l holds the value of sample l of a batch.
using Simd = double __attribute__((vector_size(8 * MOTTLE_LANES)));
/// A truth value for each lane: all bits set, or none.
using Mask = long long __attribute__((vector_size(8 * MOTTLE_LANES)));

constexpr double k_epsilon = 2.220446049250313e-16;
constexpr double k_tiny = 1e-290;

/// Written out: `Simd{} + x` would be an addition, since it turns -0 into +0.
MOTTLE_INLINE Simd broadcast(double x) {
#if MOTTLE_LANES == 8
  return Simd{x, x, x, x, x, x, x, x};
#elif MOTTLE_LANES == 4
  return Simd{x, x, x, x};
#else
  return Simd{x, x};
#endif
}

MOTTLE_INLINE Simd square_root(Simd x) {
#if defined(__AVX512F__)
  return _mm512_mask_sqrt_pd(x, 0xff, x);  // the plain form warns about its own undefined source in GCC 12
#elif defined(__AVX__)
  return _mm256_sqrt_pd(x);
#elif defined(__SSE2__)
  return _mm_sqrt_pd(x);
#else
  for (int lane = 0; lane < MOTTLE_LANES; ++lane) x[lane] = __builtin_sqrt(x[lane]);
  return x;
#endif
}

// With AVX-512 a division or a root of eight doubles takes as long as some ten to twenty products. Estimates with a
// relative error of 2^-14, whose bits differ from one make of processor to another, are doubled in length twice by
// Newton's step; one more with an exact remainder rounds correctly, so that the results are those of the division and
// the root themselves [Markstein1990]. Reciprocals of what has nothing but ones in its mantissa end one bit low, on
// every processor; below 1e-290 the remainder of a root is no longer exact.

/// 1 / x; nan for 0 and infinity.
MOTTLE_INLINE Simd reciprocal(Simd x) {
#if defined(__AVX512F__)
  const Simd one = broadcast(1.0);
  Simd y = _mm512_maskz_rcp14_pd(0xff, x);
  for (int step = 0; step < 3; ++step) y = _mm512_fmadd_pd(y, _mm512_fnmadd_pd(x, y, one), y);
  return y;
#else
  return broadcast(1.0) / x;
#endif
}

/// y / x from 1 / x.
MOTTLE_INLINE Simd quotient(Simd y, Simd x, Simd reciprocal_x) {
#if defined(__AVX512F__)
  const Simd q = y * reciprocal_x;
  return _mm512_fmadd_pd(_mm512_fnmadd_pd(q, x, y), reciprocal_x, q);
#else
  (void)reciprocal_x;
  return y / x;
#endif
}

#if defined(__AVX512F__)
struct RootPair {
  Simd root, half_inverse;  ///< sqrt(x) and nearly 1 / (2 sqrt(x))
};

MOTTLE_INLINE RootPair root_pair(Simd x) {
  const Simd half = broadcast(0.5);
  const Simd y = _mm512_maskz_rsqrt14_pd(0xff, x);
  Simd root = x * y, half_inverse = y * half;
  for (int step = 0; step < 2; ++step) {
    const Simd e = _mm512_fnmadd_pd(root, half_inverse, half);
    root = _mm512_fmadd_pd(root, e, root);
    half_inverse = _mm512_fmadd_pd(half_inverse, e, half_inverse);
  }
  return {_mm512_fmadd_pd(_mm512_fnmadd_pd(root, root, x), half_inverse, root), half_inverse};
}
#endif

/// sqrt(x); nan for 0 and infinity.
MOTTLE_INLINE Simd positive_root(Simd x) {
#if defined(__AVX512F__)
  return root_pair(x).root;
#else
  return square_root(x);
#endif
}

/// 1 / sqrt(x), of the rounded root; nan for 0 and infinity.
MOTTLE_INLINE Simd reciprocal_root(Simd x) {
#if defined(__AVX512F__)
  const RootPair pair = root_pair(x);
  const Simd y = pair.half_inverse + pair.half_inverse;
  return _mm512_fmadd_pd(y, _mm512_fnmadd_pd(pair.root, y, broadcast(1.0)), y);
#else
  return broadcast(1.0) / square_root(x);
#endif
}

MOTTLE_INLINE bool any(Mask mask) {
#if defined(__AVX512DQ__)
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask)) != 0;
#elif defined(__AVX__)
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask)) != 0;
#elif defined(__SSE2__)
  return _mm_movemask_pd(reinterpret_cast<__m128d>(mask)) != 0;
#else
  long long bits = 0;
  for (int lane = 0; lane < MOTTLE_LANES; ++lane) bits |= mask[lane];
  return bits != 0;
#endif
}

MOTTLE_INLINE Simd select(Mask mask, Simd yes, Simd no) {
  return mask ? yes : no;
}
MOTTLE_INLINE Simd smaller(Simd a, Simd b) {
  return select(a < b, a, b);
}
MOTTLE_INLINE Simd larger(Simd a, Simd b) {
  return select(a > b, a, b);
}

MOTTLE_INLINE Mask sign_bits(Simd x) {
  const Mask sign = Mask{} + static_cast<long long>(1ULL << 63);
  return reinterpret_cast<Mask>(x) & sign;
}
MOTTLE_INLINE Simd absolute(Simd x) {
  return reinterpret_cast<Simd>(reinterpret_cast<Mask>(x) ^ sign_bits(x));
}
MOTTLE_INLINE Simd flip_sign(Simd x, Mask sign) {
  return reinterpret_cast<Simd>(reinterpret_cast<Mask>(x) ^ sign);
}

/// -0 becomes +0, so that masked no-ops cannot show in the sign of a zero.
MOTTLE_INLINE Simd without_negative_zero(Simd x) {
  return x + broadcast(0.0);
}

/// False for nan and infinity.
MOTTLE_INLINE Mask is_finite(Simd x) {
  return absolute(x) <= broadcast(1.7976931348623157e308);
}

/// Index of (row, column), row >= column, in a packed lower triangle.
constexpr MOTTLE_INLINE long packed_index(long order, long row, long column) {
  return column * order - column * (column - 1) / 2 + row - column;
}

/// Compile-time index; converts to its value inside constant expressions.
template <int Value>
struct Index {
  static constexpr int value = Value;
};

/// body(Index<Begin>), ..., body(Index<End - 1>): unrolled before optimisation, so arrays become registers.
template <int Begin, int End, typename Body>
MOTTLE_INLINE void unrolled(const Body& body) {
  if constexpr (Begin < End) {
    body(Index<Begin>{});
    unrolled<Begin + 1, End>(body);
  }
}

/// The samples in the lanes of one batch; lanes past the end repeat the last sample.
struct BatchSamples {
  long sample[MOTTLE_LANES];
  int count;  ///< of lanes before the end, may be 0
};

MOTTLE_INLINE BatchSamples batch_samples(long begin, long end) {
  const long left = end > begin ? end - begin : 0;
  BatchSamples batch;
  batch.count = left < MOTTLE_LANES ? static_cast<int>(left) : MOTTLE_LANES;
  for (int lane = 0; lane < MOTTLE_LANES; ++lane) batch.sample[lane] = lane < batch.count ? begin + lane : end - 1;
  return batch;
}

MOTTLE_INLINE Simd gather(const double* coefficients, long stride, int term, const BatchSamples& batch) {
  Simd x;
  for (int lane = 0; lane < MOTTLE_LANES; ++lane) x[lane] = coefficients[batch.sample[lane] * stride + term];
  return x;
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
