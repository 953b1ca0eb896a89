#include "blas_threads.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>

namespace mottle::app {

void leave_out_blas_threads(char** arguments) {
  constexpr const char* k_threads = "OPENBLAS_NUM_THREADS";
  constexpr const char* k_mark = "MOTTLE_SET_BLAS_THREADS";  // that the variable above is not the user's
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

}  // namespace mottle::app
