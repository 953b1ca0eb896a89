// Products of a few gathered vectors with many: sums over thousands of rows, so that a BLAS would spend more time on
// rearranging both sides than on the sums.
#pragma once

#include "linalg/batched/simd/unaligned.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

constexpr int k_left = 4;                           // vectors of the left side that are worked on together
constexpr int k_panel = MOTTLE_LANES == 8 ? 6 : 3;  // registers of the right side, so that the sums fill all there are
constexpr int k_chunk = 128;                        // rows whose right side stays in the cache

/// Left vectors [first, first + Left) with Registers registers of the right ones, over the rows [from, to).
template <int Left, int Registers>
__attribute__((noinline)) void add_panel_product(const GatheredVectors& left, int first, int from, int to, int width,
                                                 const double* right, double* out) {
  Simd sum[Left][Registers];
  double* const target = out + static_cast<long>(first) * width;
  for (int v = 0; v < Left; ++v) {
    for (int l = 0; l < Registers; ++l) sum[v][l] = load(target + static_cast<long>(v) * width + l * MOTTLE_LANES);
  }
  const double* const data = left.data + first * left.vector_step;
  const long step = left.vector_step;
  for (int i = from; i < to; ++i) {
    const double* const own = data + (left.rows == nullptr ? i : left.rows[i]) * left.row_step;
    const double* const x = right + static_cast<long>(i) * width;
    for (int v = 0; v < Left; ++v) __builtin_prefetch(own + (Left + v) * step);
    for (int v = 0; v < Left; ++v) {
      const Simd value = broadcast(own[v * step]);
      for (int l = 0; l < Registers; ++l) sum[v][l] += value * load(x + l * MOTTLE_LANES);
    }
  }
  for (int v = 0; v < Left; ++v) {
    for (int l = 0; l < Registers; ++l) store(target + static_cast<long>(v) * width + l * MOTTLE_LANES, sum[v][l]);
  }
}

template <int Registers>
MOTTLE_INLINE void add_panels(const GatheredVectors& left, int from, int to, int width, const double* right,
                              double* out) {
  int first = 0;
  for (; first + k_left <= left.vectors; first += k_left) {
    add_panel_product<k_left, Registers>(left, first, from, to, width, right, out);
  }
  for (; first < left.vectors; ++first) add_panel_product<1, Registers>(left, first, from, to, width, right, out);
}

/// The widest panels that fit.
template <int Registers = k_panel>
MOTTLE_INLINE void dispatch_panels(const GatheredVectors& left, int from, int to, int registers, int width,
                                   const double* right, double* out) {
  if (registers == Registers) {
    add_panels<Registers>(left, from, to, width, right, out);
  } else if constexpr (Registers > 1) {
    dispatch_panels<Registers - 1>(left, from, to, registers, width, right, out);
  }
}

void add_gathered_product(const GatheredVectors& left, int width, const double* right, double* out) {
  for (int from = 0; from < left.row_count; from += k_chunk) {
    const int to = from + k_chunk < left.row_count ? from + k_chunk : left.row_count;
    for (int panel = 0; panel < width / MOTTLE_LANES; panel += k_panel) {
      const int rest = width / MOTTLE_LANES - panel;
      dispatch_panels(left, from, to, rest < k_panel ? rest : k_panel, width, right + panel * MOTTLE_LANES,
                      out + panel * MOTTLE_LANES);
    }
  }
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
