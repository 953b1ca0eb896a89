#include "blas.hpp"

#include <dlfcn.h>

#include <cassert>

extern "C" void dgemm_(  // NOLINT(readability-identifier-naming): Fortran's name
    const char* transposes_a, const char* transposes_b, const int* rows, const int* columns, const int* inner,
    const double* alpha, const double* a, const int* stride_a, const double* b, const int* stride_b, const double* beta,
    double* c, const int* stride_c);

namespace mottle {

void use_one_blas_thread() {
  static const bool is_done = [] {
    // Found at run time: not every BLAS has it, and those that don't have no threads.
    using SetThreads = void (*)(int);
    if (const auto set = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
    return true;
  }();
  (void)is_done;
}

void multiply(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& a, bool transposes_a,
              const Eigen::Ref<const Eigen::MatrixXd>& b, double beta, Eigen::Ref<Eigen::MatrixXd> c) {
  assert((transposes_a ? a.cols() : a.rows()) == c.rows() && (transposes_a ? a.rows() : a.cols()) == b.rows());
  if (c.size() == 0) return;
  if (b.rows() == 0) {
    c *= beta;
    return;
  }
  const int rows = static_cast<int>(c.rows());
  const int columns = static_cast<int>(c.cols());
  const int inner = static_cast<int>(b.rows());
  const int stride_a = static_cast<int>(a.outerStride());
  const int stride_b = static_cast<int>(b.outerStride());
  const int stride_c = static_cast<int>(c.outerStride());
  dgemm_(transposes_a ? "T" : "N", "N", &rows, &columns, &inner, &alpha, a.data(), &stride_a, b.data(), &stride_b,
         &beta, c.data(), &stride_c);
}

Eigen::MatrixXd transposed_product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                   const Eigen::Ref<const Eigen::MatrixXd>& b) {
  Eigen::MatrixXd product(a.cols(), b.cols());
  multiply(1.0, a, true, b, 0.0, product);
  return product;
}

}  // namespace mottle
