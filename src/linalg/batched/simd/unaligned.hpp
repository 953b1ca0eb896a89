// Load and store of SIMD registers that hold neighbouring vectors of an array [row x vector] at any address.
#pragma once

#include "linalg/batched/simd/simd.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

MOTTLE_INLINE Simd load(const double* from) {
  Simd value;
  __builtin_memcpy(&value, from, sizeof value);  // one instruction
  return value;
}
MOTTLE_INLINE void store(double* to, Simd value) {
  __builtin_memcpy(to, &value, sizeof value);
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
