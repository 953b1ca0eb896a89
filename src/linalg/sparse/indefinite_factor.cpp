// MUMPS' L D L' with pivoting, the sequential library.
#include <dmumps_c.h>

#include <mutex>
#include <vector>

#include "linalg/sparse/one_order.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/products.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {
namespace {

constexpr int k_symmetric_indefinite = 2;
constexpr int k_communicator = -987654;  // MUMPS' own number for "the world"

/// MUMPS keeps state in Fortran modules: one call at a time in a process.
ProcessMutex& one_at_a_time() {
  static constinit ProcessMutex mutex;
  return mutex;
}

class IndefiniteFactor final : public SymmetricFactor {
 public:
  IndefiniteFactor() {
    use_one_thread();
    const std::lock_guard lock(one_at_a_time());
    mumps_.job = -1;
    mumps_.par = 1;
    mumps_.sym = k_symmetric_indefinite;
    mumps_.comm_fortran = k_communicator;
    dmumps_c(&mumps_);
    for (const int stream : {0, 1, 2, 3}) mumps_.icntl[stream] = stream == 3 ? 0 : -1;  // prints nothing
  }
  IndefiniteFactor(const IndefiniteFactor&) = delete;
  IndefiniteFactor& operator=(const IndefiniteFactor&) = delete;
  ~IndefiniteFactor() override {
    const std::lock_guard lock(one_at_a_time());
    mumps_.job = -2;
    dmumps_c(&mumps_);
  }

  bool factorise(const SparseMatrix& lower) override {
    const std::lock_guard lock(one_at_a_time());
    const bool is_first = rows_.empty();
    if (is_first) list_entries(lower);
    values_.assign(lower.valuePtr(), lower.valuePtr() + lower.nonZeros());
    mumps_.a = values_.data();
    mumps_.icntl[13] = 60;  // per cent of memory above the estimate: pivoting moves entries
    if (is_first) {
      const std::lock_guard ordering(one_order_at_a_time());
      mumps_.job = 1;
      dmumps_c(&mumps_);
    }
    mumps_.job = 2;
    if (mumps_.infog[0] >= 0) dmumps_c(&mumps_);
    while (mumps_.infog[0] == -8 || mumps_.infog[0] == -9) {  // the estimate was too small
      if (mumps_.icntl[13] > 2000) break;
      mumps_.icntl[13] *= 2;
      mumps_.job = 2;
      dmumps_c(&mumps_);
    }
    if (mumps_.infog[0] == -13) {
      throw SystemFailure(fmt::format("MUMPS: not enough memory for the factor of {} equations", lower.rows()));
    }
    return mumps_.infog[0] >= 0;
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) override {
    const std::lock_guard lock(one_at_a_time());
    mumps_.rhs = right_hand_sides.data();
    mumps_.nrhs = static_cast<int>(right_hand_sides.cols());
    mumps_.lrhs = static_cast<int>(right_hand_sides.outerStride());
    mumps_.job = 3;
    dmumps_c(&mumps_);
    if (mumps_.infog[0] < 0) throw SystemFailure(fmt::format("MUMPS: the solution failed (code {})", mumps_.infog[0]));
  }

  int negative_eigenvalues() const override { return mumps_.infog[11]; }

  double factor_entries() const override {
    const double entries = mumps_.infog[28];
    return entries < 0.0 ? -1e6 * entries : entries;  // MUMPS counts large factors in millions
  }

  std::string name() const override { return "MUMPS"; }

 private:
  void list_entries(const SparseMatrix& lower) {
    for (int column = 0; column < lower.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
        rows_.push_back(static_cast<int>(entry.row()) + 1);
        columns_.push_back(column + 1);
      }
    }
    mumps_.n = static_cast<int>(lower.rows());
    mumps_.nnz = static_cast<MUMPS_INT8>(rows_.size());
    mumps_.irn = rows_.data();
    mumps_.jcn = columns_.data();
  }

  DMUMPS_STRUC_C mumps_ = {};
  std::vector<int> rows_, columns_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<SymmetricFactor> make_indefinite_factor() {
  return std::make_unique<IndefiniteFactor>();
}

}  // namespace mottle::linalg
