#include "mottle/linalg/dense/products.hpp"

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <atomic>
#include <cassert>
#include <new>

#include "linalg/batched/simd_kernels.hpp"
#include "linalg/batched/symmetric_product.hpp"

extern "C" void dgemm_(  // NOLINT(readability-identifier-naming): Fortran's name
    const char* transposes_a, const char* transposes_b, const int* rows, const int* columns, const int* inner,
    const double* alpha, const double* a, const int* stride_a, const double* b, const int* stride_b, const double* beta,
    double* c, const int* stride_c);

namespace mottle::linalg {
namespace {

/// OpenBLAS takes such a buffer for each thread that calls it at the same time as others, and tries for ever where the
/// address space is limited and has no room. Those of threads before may be taken or not yet.
void require_room_for_buffer() {
  constexpr std::size_t k_buffer = std::size_t{136} << 20;
  static std::atomic<std::size_t> threads{0};
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  const std::size_t size = k_buffer * ++threads;
  void* const room = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  ::munmap(room, size);
}

}  // namespace

void use_one_thread() {
  // Found at run time: not every BLAS has them, and those that don't have no threads.
  using Set = void (*)(int);
  static const bool is_blas_done = [] {
    if (const auto set = reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
    return true;
  }();
  // OpenMP keeps this setting by thread. No active level at all: CHOLMOD asks for a number of threads by itself.
  thread_local const bool is_openmp_done = [] {
    if (const auto set = reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"))) set(0);
    return true;
  }();
  thread_local const bool has_room = (require_room_for_buffer(), true);
  (void)is_blas_done;
  (void)is_openmp_done;
  (void)has_room;
}

namespace {

/// C = alpha op(A) op(B) + beta C; `inner` is the length of the sums.
void call_gemm(bool transposes_a, bool transposes_b, Eigen::Index inner, double alpha,
               const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b, double beta,
               Eigen::Ref<Eigen::MatrixXd> c) {
  const int rows = static_cast<int>(c.rows());
  const int columns = static_cast<int>(c.cols());
  const int length = static_cast<int>(inner);
  const int stride_a = static_cast<int>(a.outerStride());
  const int stride_b = static_cast<int>(b.outerStride());
  const int stride_c = static_cast<int>(c.outerStride());
  dgemm_(transposes_a ? "T" : "N", transposes_b ? "T" : "N", &rows, &columns, &length, &alpha, a.data(), &stride_a,
         b.data(), &stride_b, &beta, c.data(), &stride_c);
}

}  // namespace

void multiply(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& a, bool transposes_a,
              const Eigen::Ref<const Eigen::MatrixXd>& b, double beta, Eigen::Ref<Eigen::MatrixXd> c) {
  assert((transposes_a ? a.cols() : a.rows()) == c.rows() && (transposes_a ? a.rows() : a.cols()) == b.rows());
  if (c.size() == 0) return;
  if (b.rows() == 0) {
    if (beta == 0.0) {
      c.setZero();  // whatever it held, nan included
    } else {
      c *= beta;
    }
    return;
  }
  call_gemm(transposes_a, false, b.rows(), alpha, a, b, beta, c);
}

Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
  Eigen::MatrixXd result(a.rows(), b.cols());
  multiply(1.0, a, false, b, 0.0, result);
  return result;
}

VectorRows product_by_rows(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
  assert(a.cols() == b.rows() && b.rows() > 0);
  VectorRows result(a.rows(), b.cols());
  if (result.size() == 0) return result;
  // Row by row is the transpose column by column.
  const Eigen::MatrixXd transposed = b.transpose();
  call_gemm(false, true, b.rows(), 1.0, transposed, a, 0.0,
            Eigen::Map<Eigen::MatrixXd>(result.data(), result.cols(), result.rows()));
  return result;
}

Eigen::MatrixXd transposed_product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                   const Eigen::Ref<const Eigen::MatrixXd>& b) {
  Eigen::MatrixXd product(a.cols(), b.cols());
  multiply(1.0, a, true, b, 0.0, product);
  return product;
}

VectorRows transposed_product_by_rows(const Eigen::Ref<const Eigen::MatrixXd>& a, const VectorRows& b) {
  assert(a.rows() == b.rows() && b.cols() == padded_width(b.cols()));
  VectorRows result = VectorRows::Zero(a.cols(), b.cols());
  simd_kernels::kernels_for().add_gathered_product(
      {static_cast<int>(a.cols()), a.data(), 1, a.outerStride(), static_cast<int>(a.rows()), nullptr},
      static_cast<int>(b.cols()), b.data(), result.data());
  return result;
}

bool is_nearly_diagonal(const Eigen::Ref<const Eigen::MatrixXd>& a) {
  constexpr double k_negligible = 1e-11;
  const Eigen::VectorXd roots = a.diagonal().cwiseMax(0.0).cwiseSqrt();
  Eigen::MatrixXd rest = a;
  rest.diagonal().setZero();
  return (rest.cwiseAbs().array() <= k_negligible * (roots * roots.transpose()).array()).all();
}

}  // namespace mottle::linalg
