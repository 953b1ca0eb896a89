#include "blas_kernels.hpp"

#include <dlfcn.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "mottle/linalg/batched/batch_eigen.hpp"

namespace mottle::app {

namespace {

constexpr const char* k_threads = "OPENBLAS_NUM_THREADS";
constexpr const char* k_mark = "MOTTLE_SET_BLAS_THREADS";  // that the variable above is not the user's

/// OpenBLAS reads the variable before main. Its threads, which Mottle does not use, wait for memory for ever where the
/// address space is limited. Returns only where nothing is to be done.
void leave_out_blas_threads(char** arguments) {
  if (std::getenv(k_mark) != nullptr) {
    unsetenv(k_mark);
    unsetenv(k_threads);  // solvers are to have their own
    return;
  }
  rlimit limit{};
  if (std::getenv(k_threads) != nullptr || ::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
    return;
  }
  setenv(k_threads, "1", 1);
  setenv(k_mark, "1", 1);
  execv("/proc/self/exe", arguments);
  unsetenv(k_mark);
}

}  // namespace

void choose_blas_kernels(char** arguments) {
  leave_out_blas_threads(arguments);
  using CoreName = char* (*)();
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
  const auto core_name = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  if (core_name == nullptr || std::string_view(core_name()) != "Prescott") return;
  const bool has_avx512 = is_simd_level_available(SimdLevel::avx512);
  if (!has_avx512 && !is_simd_level_available(SimdLevel::avx2)) return;
  setenv("OPENBLAS_CORETYPE", has_avx512 ? "SKYLAKEX" : "HASWELL", 1);
  execv("/proc/self/exe", arguments);  // comes back only where it fails: the run is then slow, not wrong
}

}  // namespace mottle::app
