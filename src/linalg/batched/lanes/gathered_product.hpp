// Products of a few gathered vectors with many: sums over thousands of rows, so that a BLAS would spend more time on
// rearranging both sides than on the sums.
#pragma once

#include "linalg/batched/lanes/loose_lane.hpp"

namespace mottle::linalg::lane_kernels {
namespace {

constexpr int k_left = 4;                           // vectors of the left side that are worked on together
constexpr int k_panel = MOTTLE_LANES == 8 ? 6 : 3;  // lanes of the right side; the sums fill the registers
constexpr int k_chunk = 128;                        // rows whose right side stays in the cache

/// Left vectors [first, first + Left) with Lanes lanes of the right ones, over the rows [from, to).
template <int Left, int Lanes>
__attribute__((noinline)) void add_panel_product(const GatheredVectors& left, int first, int from, int to, int width,
                                                 const double* right, double* out) {
  Lane sum[Left][Lanes];
  double* const target = out + static_cast<long>(first) * width;
  for (int v = 0; v < Left; ++v) {
    for (int l = 0; l < Lanes; ++l) sum[v][l] = load(target + static_cast<long>(v) * width + l * MOTTLE_LANES);
  }
  const double* const data = left.data + first * left.vector_step;
  const long step = left.vector_step;
  for (int i = from; i < to; ++i) {
    const double* const own = data + (left.rows == nullptr ? i : left.rows[i]) * left.row_step;
    const double* const x = right + static_cast<long>(i) * width;
    for (int v = 0; v < Left; ++v) __builtin_prefetch(own + (Left + v) * step);
    for (int v = 0; v < Left; ++v) {
      const Lane value = broadcast(own[v * step]);
      for (int l = 0; l < Lanes; ++l) sum[v][l] += value * load(x + l * MOTTLE_LANES);
    }
  }
  for (int v = 0; v < Left; ++v) {
    for (int l = 0; l < Lanes; ++l) store(target + static_cast<long>(v) * width + l * MOTTLE_LANES, sum[v][l]);
  }
}

template <int Lanes>
MOTTLE_INLINE void add_panels(const GatheredVectors& left, int from, int to, int width, const double* right,
                              double* out) {
  int first = 0;
  for (; first + k_left <= left.vectors; first += k_left) {
    add_panel_product<k_left, Lanes>(left, first, from, to, width, right, out);
  }
  for (; first < left.vectors; ++first) add_panel_product<1, Lanes>(left, first, from, to, width, right, out);
}

/// The widest panels that fit.
template <int Lanes = k_panel>
MOTTLE_INLINE void dispatch_panels(const GatheredVectors& left, int from, int to, int lanes, int width,
                                   const double* right, double* out) {
  if (lanes == Lanes) {
    add_panels<Lanes>(left, from, to, width, right, out);
  } else if constexpr (Lanes > 1) {
    dispatch_panels<Lanes - 1>(left, from, to, lanes, width, right, out);
  }
}

void add_gathered_product(const GatheredVectors& left, int width, const double* right, double* out) {
  for (int from = 0; from < left.row_count; from += k_chunk) {
    const int to = from + k_chunk < left.row_count ? from + k_chunk : left.row_count;
    for (int lane = 0; lane < width / MOTTLE_LANES; lane += k_panel) {
      const int rest = width / MOTTLE_LANES - lane;
      dispatch_panels(left, from, to, rest < k_panel ? rest : k_panel, width, right + lane * MOTTLE_LANES,
                      out + lane * MOTTLE_LANES);
    }
  }
}

}  // namespace
}  // namespace mottle::linalg::lane_kernels
