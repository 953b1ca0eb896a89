#include "mottle/linalg/blas_kernels.hpp"

#include <dlfcn.h>
#include <strings.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
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

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Where all other threads sleep, and how often each has begun to; nothing where one does not sleep in a call of the
/// system. In the middle of a product a thread runs, or waits for a page of memory outside of any call.
std::optional<std::string> sleep_of_others() {
  std::error_code error;
  // By the numbers of this /proc, which may be that of an outer name space of processes.
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/thread-self", error).filename();
  if (error) return std::nullopt;
  std::string sleep;
  for (std::filesystem::directory_iterator task("/proc/self/task", error), end; !error && task != end;
       task.increment(error)) {
    if (task->path().filename() == self) continue;
    const std::string call = text_of(task->path() / "syscall");  // its number and arguments, "running" or "-1"
    if (call.empty() || call[0] < '0' || call[0] > '9') return std::nullopt;
    const std::string status = text_of(task->path() / "status");
    const std::size_t switches = status.find("voluntary_ctxt_switches");
    if (switches == std::string::npos || text_of(task->path() / "syscall") != call) return std::nullopt;
    sleep += task->path().filename().string() + ' ' + call + status.substr(switches);
  }
  return error ? std::nullopt : std::optional(sleep);
}

/// Waits until all other threads sleep, and have slept from one look to the next; false where that takes too long
/// (those of OpenBLAS wait for work awake).
bool wait_for_others_to_sleep() {
  constexpr int k_attempts = 200;
  std::optional<std::string> before;
  for (int attempt = 0; attempt < k_attempts; ++attempt) {
    const std::optional<std::string> now = sleep_of_others();
    if (now && now == before) return true;
    before = now;
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
