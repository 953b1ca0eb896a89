// Products of a sparse symmetric matrix with many vectors at once: here the lanes hold vectors, not samples.
#pragma once

#include "linalg/lanes/loose_lane.hpp"

namespace mottle::lane_kernels {
namespace {

/// One panel of Lanes * MOTTLE_LANES vectors: the column's own vectors stay in registers.
template <int Lanes>
MOTTLE_INLINE void add_panel(const SparseLower& a, int width, const double* in, double* out) {
  for (int j = 0; j < a.columns; ++j) {
    const long own = static_cast<long>(j) * width;
    Lane x[Lanes], sum[Lanes];
    for (int l = 0; l < Lanes; ++l) {
      x[l] = load(in + own + l * MOTTLE_LANES);
      sum[l] = broadcast(0.0);
    }
    for (int k = a.starts[j]; k < a.starts[j + 1]; ++k) {
      const int i = a.rows[k];
      const Lane value = broadcast(a.values[k]);
      const long other = static_cast<long>(i) * width;
      if (i == j) {
        for (int l = 0; l < Lanes; ++l) sum[l] += value * x[l];
        continue;
      }
      for (int l = 0; l < Lanes; ++l) {
        double* const target = out + other + l * MOTTLE_LANES;
        sum[l] += value * load(in + other + l * MOTTLE_LANES);
        store(target, load(target) + value * x[l]);
      }
    }
    for (int l = 0; l < Lanes; ++l) {
      double* const target = out + own + l * MOTTLE_LANES;
      store(target, load(target) + sum[l]);
    }
  }
}

void add_symmetric_product(const SparseLower& a, int width, const double* in, double* out) {
  int first = 0;
  for (; first + 4 * MOTTLE_LANES <= width; first += 4 * MOTTLE_LANES) add_panel<4>(a, width, in + first, out + first);
  for (; first + 2 * MOTTLE_LANES <= width; first += 2 * MOTTLE_LANES) add_panel<2>(a, width, in + first, out + first);
  for (; first < width; first += MOTTLE_LANES) add_panel<1>(a, width, in + first, out + first);
}

}  // namespace
}  // namespace mottle::lane_kernels
