#include "mottle/linalg/blas_kernels.hpp"

#include <dlfcn.h>
#include <strings.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "mottle/linalg/batched/batch_eigen.hpp"

namespace mottle::linalg {

namespace {

constexpr const char* k_variable = "OPENBLAS_CORETYPE";

/// A function of the BLAS in use; null where it is another one.
template <typename Function>
Function* of_openblas(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_DEFAULT, name));
}

/// Kernels of OpenBLAS that this processor can run, and that are better than the oldest; null: none.
const char* best_kernels() {
#if defined(__x86_64__) || defined(__i386__)
  if (is_simd_level_available(SimdLevel::avx512) && __builtin_cpu_supports("avx512bw") != 0 &&
      __builtin_cpu_supports("avx512cd") != 0) {
    return "SKYLAKEX";
  }
  if (is_simd_level_available(SimdLevel::avx2)) return "HASWELL";
#endif
  return nullptr;
}

/// Whether no thread but OpenBLAS's own, which wait, runs beside this one. They are all there or, after a fork, none.
bool is_alone() {
  auto* const own_threads = of_openblas<int()>("openblas_get_num_threads");
  std::error_code error;
  int threads = 0;
  for (std::filesystem::directory_iterator task("/proc/self/task", error), end; !error && task != end;
       task.increment(error)) {
    ++threads;
  }
  return !error && (threads == 1 || (own_threads != nullptr && threads == own_threads()));
}

}  // namespace

std::string blas_kernels() {
  auto* const core_name = of_openblas<char*()>("openblas_get_corename");
  return core_name == nullptr ? "" : core_name();
}

bool are_blas_kernels_outdated() {
  return std::getenv(k_variable) == nullptr && blas_kernels() == "Prescott" && best_kernels() != nullptr;
}

void choose_blas_kernels() {
  // OpenBLAS reads the variable when it chooses its kernels, which these functions of it make it do again. Its buffers
  // are of one size for all kernels; block sizes are computed anew.
  auto* const quit = of_openblas<void()>("gotoblas_dynamic_quit");
  auto* const init = of_openblas<void()>("gotoblas_dynamic_init");
  if (quit == nullptr || init == nullptr || !are_blas_kernels_outdated() || !is_alone()) return;
  const char* const wanted = best_kernels();
  ::setenv(k_variable, wanted, 1);
  quit();
  init();
  ::unsetenv(k_variable);
  if (::strcasecmp(blas_kernels().c_str(), wanted) == 0) return;
  quit();
  init();
}

}  // namespace mottle::linalg
