#include "blas_kernels.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "mottle/linalg/batch_eigen.hpp"

namespace mottle::app {

void choose_blas_kernels(char** arguments) {
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
