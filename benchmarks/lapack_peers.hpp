// LAPACK of OpenBLAS as a contender, found at run time: no development files are needed, and it is certain whose it is.
#pragma once

#include <dlfcn.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <string>
#include <vector>

namespace mottle::benchmarks {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Lowest eigenvalues, ascending, and their vectors.
struct Lowest {
  VectorXd values;
  MatrixXd vectors;
};

/// Routines of the library, by their Fortran names without the underscore.
class OpenBlas {
 public:
  OpenBlas() : library_(dlopen("libopenblas.so.0", RTLD_NOW)) {
    if (library_ == nullptr) throw std::runtime_error("libopenblas.so.0 is not installed");
  }
  std::string kernel() const { return reinterpret_cast<char* (*)()>(find("openblas_get_corename"))(); }

  template <typename... Arguments>
  void call(const char* routine, Arguments... arguments) const {
    reinterpret_cast<void (*)(Arguments...)>(find(routine))(arguments...);
  }

 private:
  void* find(const char* name) const {
    void* const symbol = dlsym(library_, name);
    if (symbol == nullptr) throw std::runtime_error(std::string(name) + ": not in libopenblas.so.0");
    return symbol;
  }
  void* library_;
};

/// Drivers and computational routines for matrices of one order, with workspaces of their optimal sizes kept.
class LapackPeers {
 public:
  LapackPeers(const OpenBlas& library, int order, int modes)
      : library_(library),
        n_(order),
        modes_(modes),
        work_(static_cast<std::size_t>(80 * order + 40000)),
        integers_(static_cast<std::size_t>(20 * order)),
        support_(static_cast<std::size_t>(2 * order)),
        all_values_(order) {
    lowest_.vectors.resize(order, modes);
  }

  /// Standard problem, relatively robust representations.
  const Lowest& dsyevr(const MatrixXd& matrix) {
    a_ = matrix;
    run_dsyevr();
    return keep();
  }

  /// Standard problem, bisection and inverse iteration.
  const Lowest& dsyevx(const MatrixXd& matrix) {
    a_ = matrix;
    library_.call("dsyevx_", "V", "I", "L", &n_, a_.data(), &n_, &zero_, &zero_, &one_, &modes_, &zero_, &found_,
                  all_values_.data(), lowest_.vectors.data(), &n_, work_.data(), &work_size(), integers_.data(),
                  support_.data(), &info_, 1L, 1L, 1L);
    return keep();
  }

  /// Generalised problem, bisection and inverse iteration.
  const Lowest& dsygvx(const MatrixXd& stiffness, const MatrixXd& mass) {
    a_ = stiffness;
    b_ = mass;
    library_.call("dsygvx_", &one_, "V", "I", "L", &n_, a_.data(), &n_, b_.data(), &n_, &zero_, &zero_, &one_, &modes_,
                  &zero_, &found_, all_values_.data(), lowest_.vectors.data(), &n_, work_.data(), &work_size(),
                  integers_.data(), support_.data(), &info_, 1L, 1L, 1L);
    return keep();
  }

  /// Generalised problem by hand: Cholesky, reduction, dsyevr, back substitution. No driver of LAPACK does this.
  const Lowest& dsygst_dsyevr(const MatrixXd& stiffness, const MatrixXd& mass) {
    a_ = stiffness;
    b_ = mass;
    library_.call("dpotrf_", "L", &n_, b_.data(), &n_, &info_, 1L);
    library_.call("dsygst_", &one_, "L", &n_, a_.data(), &n_, b_.data(), &n_, &info_, 1L);
    run_dsyevr();
    library_.call("dtrsm_", "L", "L", "T", "N", &n_, &modes_, &unit_, b_.data(), &n_, lowest_.vectors.data(), &n_, 1L,
                  1L, 1L, 1L);
    return keep();
  }

 private:
  void run_dsyevr() {
    library_.call("dsyevr_", "V", "I", "L", &n_, a_.data(), &n_, &zero_, &zero_, &one_, &modes_, &zero_, &found_,
                  all_values_.data(), lowest_.vectors.data(), &n_, support_.data(), work_.data(), &work_size(),
                  integers_.data(), &integer_size(), &info_, 1L, 1L, 1L);
  }
  const Lowest& keep() {
    if (info_ != 0 || found_ != modes_) throw std::runtime_error("LAPACK failed");
    lowest_.values = all_values_.head(modes_);
    return lowest_;
  }
  const int& work_size() { return work_size_ = static_cast<int>(work_.size()); }
  const int& integer_size() { return integer_size_ = static_cast<int>(integers_.size()); }

  const OpenBlas& library_;
  int n_, modes_;
  int one_ = 1, found_ = 0, info_ = 0, work_size_ = 0, integer_size_ = 0;
  double zero_ = 0.0, unit_ = 1.0;
  MatrixXd a_, b_;
  std::vector<double> work_;
  std::vector<int> integers_, support_;
  VectorXd all_values_;
  Lowest lowest_;
};

}  // namespace mottle::benchmarks
