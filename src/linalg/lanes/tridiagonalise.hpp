// Householder tridiagonalisation Q' A Q = T of a packed lower triangle, and the way back, z <- Q z.
#pragma once

#include "linalg/lanes/workspace.hpp"

namespace mottle::lane_kernels {
namespace {

/// Turns x[first..n) into a reflector (I - tau v v') x = beta e_first with v[first] = 1, written over x.
MOTTLE_INLINE Lane make_reflector(Lane* x, int first, int n, Lane& tau) {
  Lane even = broadcast(0.0), odd = broadcast(0.0);
  int i = first + 1;
  for (; i + 1 < n; i += 2) {
    even += x[i] * x[i];
    odd += x[i + 1] * x[i + 1];
  }
  if (i < n) even += x[i] * x[i];
  const Lane tail = even + odd;
  const Lane alpha = x[first];
  const Mask trivial = tail == broadcast(0.0);
  // beta takes the sign opposite to alpha: alpha - beta adds, nothing cancels.
  const Lane beta = flip_sign(-square_root(alpha * alpha + tail), sign_bits(alpha));
  const Lane scale = select(trivial, broadcast(0.0), broadcast(1.0) / (alpha - beta));
  tau = select(trivial, broadcast(0.0), (beta - alpha) / beta);
  x[first] = broadcast(1.0);
  for (i = first + 1; i < n; ++i) x[i] *= scale;
  return select(trivial, alpha, beta);
}

/// The vectors of one step: A <- A - v w' - w v' from the step before, p <- A u for this step's reflector u.
struct FusedStep {
  const Lane* v;
  const Lane* w;
  const Lane* u;
  Lane* p;
};

/// One block of columns [first, first + Columns) of the fused update and product: each entry is loaded and stored
/// once for both.
template <int Columns>
MOTTLE_INLINE void fused_columns(Lane* matrix, int n, int first, const FusedStep& step) {
  Lane* column[Columns];
  Lane vj[Columns], wj[Columns], uj[Columns], sum[Columns];
  for (int c = 0; c < Columns; ++c) {
    const int j = first + c;
    column[c] = matrix + packed_index(n, j, j) - j;
    vj[c] = step.v[j];
    wj[c] = step.w[j];
    uj[c] = step.u[j];
    sum[c] = broadcast(0.0);
  }
  for (int c = 0; c < Columns; ++c) {
    for (int r = c; r < Columns; ++r) {
      const int i = first + r;
      const Lane a = column[c][i] - step.v[i] * wj[c] - step.w[i] * vj[c];
      column[c][i] = a;
      sum[c] += a * uj[r];
      if (r != c) sum[r] += a * uj[c];
    }
  }
  for (int i = first + Columns; i < n; ++i) {
    const Lane vi = step.v[i], wi = step.w[i], ui = step.u[i];
    Lane pi = step.p[i];
    for (int c = 0; c < Columns; ++c) {
      const Lane a = column[c][i] - vi * wj[c] - wi * vj[c];
      column[c][i] = a;
      pi += a * uj[c];
      sum[c] += a * ui;
    }
    step.p[i] = pi;
  }
  for (int c = 0; c < Columns; ++c) step.p[first + c] += sum[c];
}

inline void fused_update_and_product(Lane* matrix, int n, int first, const FusedStep& step) {
  for (int i = first; i < n; ++i) step.p[i] = broadcast(0.0);
  int j = first;
  for (; j + MOTTLE_COLUMN_BLOCK <= n; j += MOTTLE_COLUMN_BLOCK) {
    fused_columns<MOTTLE_COLUMN_BLOCK>(matrix, n, j, step);
  }
  for (; j < n; ++j) fused_columns<1>(matrix, n, j, step);
}

/// w <- tau p - (tau^2 p'u / 2) u, so that the step's similarity is A - u w' - w u'.
inline void make_update(Lane* w, const Lane* p, const Lane* u, Lane tau, int first, int n) {
  Lane dot = broadcast(0.0);
  for (int i = first; i < n; ++i) dot += p[i] * u[i];
  const Lane half = tau * tau * dot * 0.5;
  for (int i = first; i < n; ++i) w[i] = tau * p[i] - half * u[i];
}

/// work.matrix -> work.diagonal, work.offdiag; reflectors stay in the columns of work.matrix and in work.tau.
inline void tridiagonalise(const Workspace& work, int n) {
  Lane* const w = work.update;
  const Lane* v = work.product;  // no update pends before the first step: both vectors zero
  for (int i = 0; i < n; ++i) w[i] = work.product[i] = broadcast(0.0);
  for (int k = 0; k + 1 < n; ++k) {
    Lane* const column = work.matrix + packed_index(n, k, k) - k;
    const Lane vk = v[k], wk = w[k];
    for (int i = k; i < n; ++i) column[i] -= v[i] * wk + w[i] * vk;
    work.diagonal[k] = column[k];
    work.offdiag[k] = make_reflector(column, k + 1, n, work.tau[k]);
    // The first product would overwrite the zeros that it reads as v: vk and the rows above are zero already.
    Lane* const p = k == 0 ? work.squares : work.product;
    fused_update_and_product(work.matrix, n, k + 1, {v, w, column, p});
    make_update(w, p, column, work.tau[k], k + 1, n);
    v = column;
  }
  work.diagonal[n - 1] = work.matrix[packed_index(n, n - 1, n - 1)] - v[n - 1] * w[n - 1] - w[n - 1] * v[n - 1];
  work.offdiag[n - 1] = broadcast(0.0);
}

/// z_c <- Q z_c for `Columns` vectors that lie n apart.
template <int Columns>
MOTTLE_INLINE void apply_reflectors(const Workspace& work, int n, Lane* z) {
  for (int k = n - 2; k >= 0; --k) {
    const Lane* const v = work.matrix + packed_index(n, k, k) - k;
    Lane dot[Columns];
    for (int c = 0; c < Columns; ++c) dot[c] = z[c * n + k + 1];
    for (int i = k + 2; i < n; ++i) {
      for (int c = 0; c < Columns; ++c) dot[c] += v[i] * z[c * n + i];
    }
    for (int c = 0; c < Columns; ++c) {
      dot[c] *= work.tau[k];
      z[c * n + k + 1] -= dot[c];
    }
    for (int i = k + 2; i < n; ++i) {
      for (int c = 0; c < Columns; ++c) z[c * n + i] -= v[i] * dot[c];
    }
  }
}

inline void transform_back(const Workspace& work, int n, int modes) {
  int mode = 0;
  for (; mode + 4 <= modes; mode += 4) apply_reflectors<4>(work, n, work.vectors + static_cast<long>(mode) * n);
  for (; mode < modes; ++mode) apply_reflectors<1>(work, n, work.vectors + static_cast<long>(mode) * n);
}

}  // namespace
}  // namespace mottle::lane_kernels
