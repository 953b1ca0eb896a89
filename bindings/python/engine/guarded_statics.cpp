// The static objects of functions, made while no other thread forks: a forked process would wait for ever for a thread
// that was making one. The linker puts these in the place of the compiler's calls in all objects of this module, those
// of Eigen, Boost and the library among them (-Wl,--wrap).
#include <cxxabi.h>

#include "mottle/core/process_mutex.hpp"

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker's names
extern "C" {
int __real___cxa_guard_acquire(abi::__guard* guard);
void __real___cxa_guard_release(abi::__guard* guard) noexcept;
void __real___cxa_guard_abort(abi::__guard* guard) noexcept;

int __wrap___cxa_guard_acquire(abi::__guard* guard) {
  mottle::NoFork::begin();
  const int is_mine = __real___cxa_guard_acquire(guard);
  if (is_mine == 0) mottle::NoFork::end();
  return is_mine;
}

void __wrap___cxa_guard_release(abi::__guard* guard) noexcept {
  __real___cxa_guard_release(guard);
  mottle::NoFork::end();
}

void __wrap___cxa_guard_abort(abi::__guard* guard) noexcept {
  __real___cxa_guard_abort(guard);
  mottle::NoFork::end();
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
