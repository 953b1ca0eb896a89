// CHOLMOD's supernodal L L', with solutions by the SIMD kernels.
#include <suitesparse/cholmod.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "linalg/batched/simd_kernels.hpp"
#include "linalg/sparse/node_order.hpp"
#include "linalg/sparse/one_order.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/products.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {
namespace {

constexpr Eigen::Index k_nested_dissection_from = 3000;  // below, minimum degree is found faster and is as good
constexpr Eigen::Index k_max_sides = 32;                 // in one sweep through L; more would only need more memory

/// Eight doubles that lie in one line of the cache.
struct alignas(64) CacheLine {
  double values[8];
};

/// Views Eigen's arrays as CHOLMOD's; nothing is copied. Without entries Eigen has no arrays, but CHOLMOD wants some.
cholmod_sparse view(const SparseMatrix& lower) {
  static int no_row = 0;
  static double no_value = 0.0;
  const bool is_empty = lower.nonZeros() == 0;
  cholmod_sparse sparse = {};
  sparse.nrow = static_cast<std::size_t>(lower.rows());
  sparse.ncol = static_cast<std::size_t>(lower.cols());
  sparse.nzmax = static_cast<std::size_t>(lower.nonZeros());
  sparse.p = const_cast<int*>(lower.outerIndexPtr());
  sparse.i = is_empty ? &no_row : const_cast<int*>(lower.innerIndexPtr());
  sparse.x = is_empty ? &no_value : const_cast<double*>(lower.valuePtr());
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_REAL;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = 1;
  sparse.packed = 1;
  return sparse;
}

class CholmodFactor final : public DefiniteFactor {
 public:
  explicit CholmodFactor(std::vector<int> order) : given_order_(std::move(order)) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;
  ~CholmodFactor() override {
    cholmod_free_dense(&solution_, &common_);
    cholmod_free_dense(&work_, &common_);
    cholmod_free_dense(&more_work_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  bool factorise(const SparseMatrix& lower) override {
    use_one_thread();
    cholmod_sparse matrix = view(lower);
    if (factor_ == nullptr) {
      const std::lock_guard lock(one_order_at_a_time());
      if (given_order_.empty() && lower.rows() >= k_nested_dissection_from) given_order_ = order_by_nodes(lower);
      common_.nmethods = 1;
      common_.method[0].ordering = !given_order_.empty()                     ? CHOLMOD_GIVEN
                                   : lower.rows() < k_nested_dissection_from ? CHOLMOD_AMD
                                                                             : CHOLMOD_METIS;
      common_.postorder = 1;
      factor_ = cholmod_analyze_p(&matrix, given_order_.empty() ? nullptr : given_order_.data(), nullptr, 0, &common_);
      if (factor_ == nullptr) throw SystemFailure("CHOLMOD cannot analyse the matrix: out of memory or too large");
    }
    cholmod_factorize(&matrix, factor_, &common_);
    if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE) {
      throw SystemFailure(fmt::format("CHOLMOD: not enough memory for the factor of {} equations", lower.rows()));
    }
    is_definite_ = common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
    return is_definite_;
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) override {
    if (has_supernodes()) return sweep(right_hand_sides, false);
    solve_part(CHOLMOD_A, right_hand_sides);
  }

  void solve_rows(Eigen::Ref<VectorRows> right_hand_sides) override { solve_by_rows(right_hand_sides, false); }

  void solve_root(Eigen::Ref<VectorRows> right_hand_sides) override { solve_by_rows(right_hand_sides, true); }

  int negative_eigenvalues() const override { return 0; }

  int failed_column() const override {
    if (factor_ == nullptr || is_definite_) return -1;
    return static_cast<const int*>(factor_->Perm)[factor_->minor];
  }

  std::vector<int> order() const override {
    if (factor_ == nullptr) return {};
    const int* const rows = static_cast<const int*>(factor_->Perm);
    return {rows, rows + factor_->n};
  }

  double factor_entries() const override { return factor_ == nullptr ? 0.0 : static_cast<double>(factor_->xsize); }

  std::string name() const override { return "CHOLMOD supernodal"; }

 private:
  bool has_supernodes() const {
    return factor_ != nullptr && factor_->is_super != 0 && factor_->xtype == CHOLMOD_REAL &&
           factor_->itype == CHOLMOD_INT;
  }

  simd_kernels::SupernodalLower supernodes() const {
    return {static_cast<int>(factor_->nsuper),    static_cast<const int*>(factor_->super),
            static_cast<const int*>(factor_->pi), static_cast<const int*>(factor_->s),
            static_cast<const int*>(factor_->px), static_cast<const double*>(factor_->x)};
  }

  /// P' L^-T L^-1 P B, or its second half P' L^-T B alone: the root.
  template <typename Sides>
  void sweep(Sides& right_hand_sides, bool is_root) {
    const simd_kernels::Kernels& kernels = simd_kernels::kernels_for();
    const simd_kernels::SupernodalLower lower = supernodes();
    const int* order = static_cast<const int*>(factor_->Perm);
    const Eigen::Index rows = right_hand_sides.rows();
    std::vector<CacheLine> sides_by_rows;  // the layout of the kernels
    for (Eigen::Index first = 0; first < right_hand_sides.cols(); first += k_max_sides) {
      const Eigen::Index sides = std::min(k_max_sides, right_hand_sides.cols() - first);
      const Eigen::Index width = sides == 1 ? 1 : (sides + kernels.lanes - 1) / kernels.lanes * kernels.lanes;
      sides_by_rows.resize(static_cast<std::size_t>(rows * width / 8 + 1));
      double* const x = sides_by_rows.data()->values;
      for (Eigen::Index i = 0; i < rows; ++i) {
        const Eigen::Index row = is_root ? i : order[i];
        for (Eigen::Index j = 0; j < sides; ++j) x[i * width + j] = right_hand_sides(row, first + j);
        std::fill(x + i * width + sides, x + (i + 1) * width, 0.0);
      }
      if (!is_root) kernels.solve_lower(lower, static_cast<int>(width), x);
      kernels.solve_lower_transposed(lower, static_cast<int>(width), x);
      for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index j = 0; j < sides; ++j) right_hand_sides(order[i], first + j) = x[i * width + j];
      }
    }
  }

  void solve_by_rows(Eigen::Ref<VectorRows> right_hand_sides, bool is_root) {
    if (has_supernodes()) return sweep(right_hand_sides, is_root);
    Eigen::MatrixXd columns = right_hand_sides;
    solve_part(is_root ? CHOLMOD_Lt : CHOLMOD_A, columns);
    if (is_root) solve_part(CHOLMOD_Pt, columns);
    right_hand_sides = columns;
  }

  void solve_part(int system, Eigen::Ref<Eigen::MatrixXd> right_hand_sides) {
    use_one_thread();
    const std::lock_guard lock(mutex_);
    cholmod_dense sides = {};
    sides.nrow = static_cast<std::size_t>(right_hand_sides.rows());
    sides.ncol = static_cast<std::size_t>(right_hand_sides.cols());
    sides.d = static_cast<std::size_t>(right_hand_sides.outerStride());
    sides.nzmax = sides.d * sides.ncol;
    sides.x = right_hand_sides.data();
    sides.xtype = CHOLMOD_REAL;
    sides.dtype = CHOLMOD_DOUBLE;
    if (cholmod_solve2(system, factor_, &sides, nullptr, &solution_, nullptr, &work_, &more_work_, &common_) == 0) {
      throw SystemFailure("CHOLMOD: not enough memory to solve");
    }
    right_hand_sides = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
        static_cast<const double*>(solution_->x), right_hand_sides.rows(), right_hand_sides.cols(),
        Eigen::OuterStride<>(static_cast<Eigen::Index>(solution_->d)));
  }

  std::vector<int> given_order_;
  cholmod_common common_ = {};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* solution_ = nullptr;
  cholmod_dense* work_ = nullptr;
  cholmod_dense* more_work_ = nullptr;
  std::mutex mutex_;  // of CHOLMOD's own solutions
  bool is_definite_ = false;
};

}  // namespace

std::unique_ptr<DefiniteFactor> make_definite_factor(std::vector<int> order) {
  return std::make_unique<CholmodFactor>(std::move(order));
}

}  // namespace mottle::linalg
