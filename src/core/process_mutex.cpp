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

void ProcessMutex::lock() {
  enter();
  mutex_.lock();
}

void ProcessMutex::unlock() {
  mutex_.unlock();
  leave();
}

}  // namespace mottle
