// Load and store of SIMD registers that hold neighbouring vectors of an array [row x vector] at any address.
#pragma once

#include "linalg/batched/simd/simd.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// A SIMD register's value at any address.
using UnalignedSimd = double __attribute__((vector_size(8 * MOTTLE_LANES), aligned(8)));

MOTTLE_INLINE Simd load(const double* from) {
  return *reinterpret_cast<const UnalignedSimd*>(from);
}
MOTTLE_INLINE void store(double* to, Simd value) {
  *reinterpret_cast<UnalignedSimd*>(to) = value;
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
