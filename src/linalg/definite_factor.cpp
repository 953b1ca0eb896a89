// CHOLMOD's supernodal L L'.
#include <suitesparse/cholmod.h>

#include <cstring>
#include <vector>

#include "blas.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/symmetric_factor.hpp"

namespace mottle {
namespace {

constexpr Eigen::Index k_nested_dissection_from = 3000;  // below, minimum degree is found faster and is as good

/// Views Eigen's arrays as CHOLMOD's; nothing is copied.
cholmod_sparse view(const SparseMatrix& lower) {
  cholmod_sparse sparse = {};
  sparse.nrow = static_cast<std::size_t>(lower.rows());
  sparse.ncol = static_cast<std::size_t>(lower.cols());
  sparse.nzmax = static_cast<std::size_t>(lower.nonZeros());
  sparse.p = const_cast<int*>(lower.outerIndexPtr());
  sparse.i = const_cast<int*>(lower.innerIndexPtr());
  sparse.x = const_cast<double*>(lower.valuePtr());
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
  CholmodFactor() {
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
      common_.nmethods = 1;
      common_.method[0].ordering = lower.rows() < k_nested_dissection_from ? CHOLMOD_AMD : CHOLMOD_METIS;
      common_.postorder = 1;
      factor_ = cholmod_analyze(&matrix, &common_);
      if (factor_ == nullptr) throw SystemFailure("CHOLMOD cannot analyse the matrix: out of memory or too large");
    }
    cholmod_factorize(&matrix, factor_, &common_);
    if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE) {
      throw SystemFailure(fmt::format("CHOLMOD: not enough memory for the factor of {} equations", lower.rows()));
    }
    is_definite_ = common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
    return is_definite_;
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) override { solve_part(CHOLMOD_A, right_hand_sides); }

  void solve_root(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) override {
    solve_part(CHOLMOD_Lt, right_hand_sides);
    solve_part(CHOLMOD_Pt, right_hand_sides);
  }

  int negative_eigenvalues() const override { return 0; }

  int failed_column() const override {
    if (factor_ == nullptr || is_definite_) return -1;
    return static_cast<const int*>(factor_->Perm)[factor_->minor];
  }

  double factor_entries() const override { return factor_ == nullptr ? 0.0 : static_cast<double>(factor_->xsize); }

  std::string name() const override { return "CHOLMOD supernodal"; }

 private:
  void solve_part(int system, Eigen::Ref<Eigen::MatrixXd> right_hand_sides) {
    use_one_thread();
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

  cholmod_common common_ = {};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* solution_ = nullptr;
  cholmod_dense* work_ = nullptr;
  cholmod_dense* more_work_ = nullptr;
  bool is_definite_ = false;
};

}  // namespace

std::unique_ptr<DefiniteFactor> make_definite_factor() {
  return std::make_unique<CholmodFactor>();
}

}  // namespace mottle
