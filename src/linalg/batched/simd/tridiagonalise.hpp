// Householder tridiagonalisation Q' A Q = T of a packed lower triangle, and the way back, z <- Q z.
#pragma once

#include "linalg/batched/simd/workspace.hpp"

namespace mottle::linalg::simd_kernels {
namespace {

/// Turns x[first..n) into a reflector (I - tau v v') x = beta e_first with v[first] = 1, written over x.
MOTTLE_INLINE Simd make_reflector(Simd* x, int first, int n, Simd& tau) {
  Simd even = broadcast(0.0), odd = broadcast(0.0);
  int i = first + 1;
  for (; i + 1 < n; i += 2) {
    even += x[i] * x[i];
    odd += x[i + 1] * x[i + 1];
  }
  if (i < n) even += x[i] * x[i];
  const Simd tail = even + odd;
  const Simd alpha = x[first];
  const Mask trivial = tail == broadcast(0.0);
  // beta takes the sign opposite to alpha: alpha - beta adds, nothing cancels.
  const Simd beta = flip_sign(-square_root(alpha * alpha + tail), sign_bits(alpha));
  const Simd scale = select(trivial, broadcast(0.0), broadcast(1.0) / (alpha - beta));
  tau = select(trivial, broadcast(0.0), (beta - alpha) / beta);
  x[first] = broadcast(1.0);
  for (i = first + 1; i < n; ++i) x[i] *= scale;
  return select(trivial, alpha, beta);
}

/// A rank-2 update that waits: A - v w' - w v'.
struct Pending {
  const Simd* v;
  const Simd* w;
};

/// The vectors of one pass: the updates before it, this step's reflector u, and p <- A u.
struct Pass {
  Pending pending[2];
  const Simd* u;
  Simd* p;
};

/// One block of columns [first, first + Columns): applies Pairs pending updates and adds the block's part of A u, each
/// entry loaded once for both, and not stored where it stays.
template <int Columns, int Pairs>
MOTTLE_INLINE void pass_columns(Simd* matrix, int n, int first, const Pass& pass) {
  constexpr int k_pairs = Pairs > 0 ? Pairs : 1;  // no array without elements
  Simd* column[Columns];
  Simd vj[k_pairs][Columns], wj[k_pairs][Columns], uj[Columns], sum[Columns];
  for (int c = 0; c < Columns; ++c) {
    const int j = first + c;
    column[c] = matrix + packed_index(n, j, j) - j;
    uj[c] = pass.u[j];
    sum[c] = broadcast(0.0);
    for (int q = 0; q < Pairs; ++q) {
      vj[q][c] = pass.pending[q].v[j];
      wj[q][c] = pass.pending[q].w[j];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    for (int r = c; r < Columns; ++r) {
      const int i = first + r;
      Simd a = column[c][i];
      for (int q = 0; q < Pairs; ++q) a = a - pass.pending[q].v[i] * wj[q][c] - pass.pending[q].w[i] * vj[q][c];
      if (Pairs > 0) column[c][i] = a;
      sum[c] += a * uj[r];
      if (r != c) sum[r] += a * uj[c];
    }
  }
  for (int i = first + Columns; i < n; ++i) {
    Simd vi[k_pairs], wi[k_pairs];
    for (int q = 0; q < Pairs; ++q) {
      vi[q] = pass.pending[q].v[i];
      wi[q] = pass.pending[q].w[i];
    }
    const Simd ui = pass.u[i];
    Simd pi = pass.p[i];
    for (int c = 0; c < Columns; ++c) {
      Simd a = column[c][i];
      for (int q = 0; q < Pairs; ++q) a = a - vi[q] * wj[q][c] - wi[q] * vj[q][c];
      if (Pairs > 0) column[c][i] = a;
      pi += a * uj[c];
      sum[c] += a * ui;
    }
    pass.p[i] = pi;
  }
  for (int c = 0; c < Columns; ++c) pass.p[first + c] += sum[c];
}

/// A <- A less the pending updates, if Pairs > 0, and p <- A u, on the trailing block from `first`.
template <int Columns, int Pairs>
inline void run_pass(Simd* matrix, int n, int first, const Pass& pass) {
  for (int i = first; i < n; ++i) pass.p[i] = broadcast(0.0);
  int j = first;
  for (; j + Columns <= n; j += Columns) pass_columns<Columns, Pairs>(matrix, n, j, pass);
  for (; j < n; ++j) pass_columns<1, Pairs>(matrix, n, j, pass);
}

/// p <- p - v (w'u) - w (v'u): the product with an update that waits.
inline void correct_product(const Pending& pending, const Simd* u, Simd* p, int first, int n) {
  Simd along_v = broadcast(0.0), along_w = broadcast(0.0);
  for (int i = first; i < n; ++i) {
    along_v += pending.v[i] * u[i];
    along_w += pending.w[i] * u[i];
  }
  for (int i = first; i < n; ++i) p[i] -= pending.v[i] * along_w + pending.w[i] * along_v;
}

/// w <- tau p - (tau^2 p'u / 2) u, so that the step's similarity is A - u w' - w u'.
inline void make_update(Simd* w, const Simd* p, const Simd* u, Simd tau, int first, int n) {
  Simd dot = broadcast(0.0);
  for (int i = first; i < n; ++i) dot += p[i] * u[i];
  const Simd half = tau * tau * dot * 0.5;
  for (int i = first; i < n; ++i) w[i] = tau * p[i] - half * u[i];
}

/// work.matrix -> work.diagonal, work.offdiag; reflectors stay in the columns of work.matrix and in work.tau. Updates
/// wait until there are two: half of the passes over the matrix only read it.
inline void tridiagonalise(const Workspace& work, int n) {
  Pass pass{{{nullptr, work.update}, {nullptr, work.update + n}}, nullptr, work.product};
  int waiting = 0;
  for (int k = 0; k + 1 < n; ++k) {
    Simd* const column = work.matrix + packed_index(n, k, k) - k;
    for (int q = 0; q < waiting; ++q) {
      const Pending& update = pass.pending[q];
      const Simd vk = update.v[k], wk = update.w[k];
      for (int i = k; i < n; ++i) column[i] -= update.v[i] * wk + update.w[i] * vk;
    }
    work.diagonal[k] = column[k];
    work.offdiag[k] = make_reflector(column, k + 1, n, work.tau[k]);
    pass.u = column;
    if (waiting == 2) {
      run_pass<MOTTLE_UPDATE_COLUMNS, 2>(work.matrix, n, k + 1, pass);
      waiting = 0;
    } else {
      run_pass<MOTTLE_PRODUCT_COLUMNS, 0>(work.matrix, n, k + 1, pass);
      if (waiting == 1) correct_product(pass.pending[0], column, work.product, k + 1, n);
    }
    pass.pending[waiting].v = column;
    make_update(work.update + static_cast<long>(waiting) * n, work.product, column, work.tau[k], k + 1, n);
    ++waiting;
  }
  Simd last = work.matrix[packed_index(n, n - 1, n - 1)];
  for (int q = 0; q < waiting; ++q) last -= pass.pending[q].v[n - 1] * pass.pending[q].w[n - 1] * 2.0;
  work.diagonal[n - 1] = last;
  work.offdiag[n - 1] = broadcast(0.0);
}

/// z_c <- H_k z_c for `Columns` vectors that lie n apart.
template <int Columns>
MOTTLE_INLINE void apply_reflector(const Workspace& work, int n, int k, Simd* z) {
  const Simd* const v = work.matrix + packed_index(n, k, k) - k;
  Simd dot[Columns];
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

/// z_c <- H_k H_{k+1} z_c in one pass for the products and one for the update:
///
///   a = u'z tau_u,   b = (v'z - v'u a) tau_v,   z <- z - u a - v b,   u of reflector k + 1, v of reflector k
template <int Columns>
MOTTLE_INLINE void apply_two_reflectors(const Workspace& work, int n, int k, Simd* z) {
  const Simd* const v = work.matrix + packed_index(n, k, k) - k;
  const Simd* const u = work.matrix + packed_index(n, k + 1, k + 1) - (k + 1);
  Simd along_u[Columns], along_v[Columns];
  const Simd shared = v[k + 2];
  Simd between = shared;
  for (int c = 0; c < Columns; ++c) {
    along_u[c] = z[c * n + k + 2];
    along_v[c] = z[c * n + k + 1] + shared * along_u[c];
  }
  for (int i = k + 3; i < n; ++i) {
    const Simd vi = v[i], ui = u[i];
    between += vi * ui;
    for (int c = 0; c < Columns; ++c) {
      along_u[c] += ui * z[c * n + i];
      along_v[c] += vi * z[c * n + i];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    along_u[c] *= work.tau[k + 1];
    along_v[c] = (along_v[c] - between * along_u[c]) * work.tau[k];
    z[c * n + k + 1] -= along_v[c];
    z[c * n + k + 2] -= along_u[c] + shared * along_v[c];
  }
  for (int i = k + 3; i < n; ++i) {
    const Simd vi = v[i], ui = u[i];
    for (int c = 0; c < Columns; ++c) z[c * n + i] -= ui * along_u[c] + vi * along_v[c];
  }
}

/// z_c <- Q z_c for `Columns` vectors that lie n apart.
template <int Columns>
MOTTLE_INLINE void apply_reflectors(const Workspace& work, int n, Simd* z) {
  int k = n - 2;
  for (; k >= 1; k -= 2) apply_two_reflectors<Columns>(work, n, k - 1, z);
  if (k == 0) apply_reflector<Columns>(work, n, 0, z);
}

inline void transform_back(const Workspace& work, int n, int modes) {
  int mode = 0;
  for (; mode + 5 <= modes; mode += 5) apply_reflectors<5>(work, n, work.vectors + static_cast<long>(mode) * n);
  for (; mode < modes; ++mode) apply_reflectors<1>(work, n, work.vectors + static_cast<long>(mode) * n);
}

}  // namespace
}  // namespace mottle::linalg::simd_kernels
