#include "mottle/linalg/blas_kernels.hpp"

#include <dlfcn.h>
#include <strings.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

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

/// Whether the thread of this number, of this process, sleeps; false where that cannot be read.
bool is_asleep(const std::string& thread) {
  std::ifstream file("/proc/self/task/" + thread + "/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_end = line.rfind(')');  // "number (name) state ...", whatever the name holds
  return name_end != std::string::npos && line.compare(name_end, 4, ") S ") == 0;
}

/// Whether no other thread of the process is running, or about to: in the middle of a product at least one is.
bool do_others_sleep() {
  const std::string self = std::to_string(::gettid());
  std::error_code error;
  for (std::filesystem::directory_iterator task("/proc/self/task", error), end; !error && task != end;
       task.increment(error)) {
    const std::string thread = task->path().filename().string();
    if (thread != self && !is_asleep(thread)) return false;
  }
  return !error;
}

/// Waits until all other threads sleep; false where that takes too long (those of OpenBLAS wait for work awake).
bool wait_for_others_to_sleep() {
  constexpr int k_attempts = 200;
  for (int attempt = 0; attempt < k_attempts; ++attempt) {
    if (do_others_sleep()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
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
  if (quit == nullptr || init == nullptr || !are_blas_kernels_outdated()) return;
  if (!wait_for_others_to_sleep()) return;
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
