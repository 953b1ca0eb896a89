// Lanes that hold neighbouring vectors of an array [row x vector], wherever it begins.
#pragma once

#include "linalg/batched/lanes/lane.hpp"

namespace mottle::linalg::lane_kernels {
namespace {

/// Lanes at any address.
using LooseLane = double __attribute__((vector_size(8 * MOTTLE_LANES), aligned(8)));

MOTTLE_INLINE Lane load(const double* from) {
  return *reinterpret_cast<const LooseLane*>(from);
}
MOTTLE_INLINE void store(double* to, Lane value) {
  *reinterpret_cast<LooseLane*>(to) = value;
}

}  // namespace
}  // namespace mottle::linalg::lane_kernels
