#include "mottle/core/process_mutex.hpp"

#include <pthread.h>

namespace mottle {
namespace {

// Held by readers while they need that nobody forks, by the thread that forks as the writer. Writers come first: a fork
// waits for those who hold it, and not for those who come after.
constexpr pthread_rwlock_t k_free = PTHREAD_RWLOCK_WRITER_NONRECURSIVE_INITIALIZER_NP;
constinit pthread_rwlock_t gate = k_free;
constinit thread_local int depth = 0;  // how many of these this thread holds; the outermost one is the reader

void enter() {
  if (depth++ == 0) ::pthread_rwlock_rdlock(&gate);
}

void leave() {
  if (--depth == 0) ::pthread_rwlock_unlock(&gate);
}

/// A thread that forks while it holds one itself cannot wait for the others.
void before_fork() {
  if (depth == 0) ::pthread_rwlock_wrlock(&gate);
}

void after_fork() {
  if (depth == 0) ::pthread_rwlock_unlock(&gate);
}

/// The lock remembers its writer by the thread's number, which is another one in the forked process: it is made anew.
void begin_process() {
  gate = k_free;
  if (depth > 0) ::pthread_rwlock_rdlock(&gate);
}

[[maybe_unused]] const int k_is_registered = ::pthread_atfork(before_fork, after_fork, begin_process);

}  // namespace

NoFork::NoFork() {
  enter();
}
NoFork::~NoFork() {
  leave();
}

void NoFork::begin() {
  enter();
}
void NoFork::end() {
  leave();
}

void ProcessMutex::lock() {
  // A fork waits for the thread that has it and not for those that queue for it.
  while (true) {
    enter();
    if (is_held_.exchange(1, std::memory_order_acquire) == 0) return;
    leave();
    is_held_.wait(1);
  }
}

void ProcessMutex::unlock() {
  is_held_.store(0, std::memory_order_release);
  is_held_.notify_one();
  leave();
}

}  // namespace mottle
