// Mutexes of what all threads of a process share.
#pragma once

#include <mutex>

namespace mottle {

/// A mutex for static objects. A process that is forked has none of the other threads of the first one: a mutex that
/// one of them held would never be unlocked there, and what it guards stay half changed. So a fork (by fork(), as
/// Python's multiprocessing starts processes; not by posix_spawn()) waits until no other thread holds such a mutex.
class ProcessMutex {
 public:
  ProcessMutex();
  ~ProcessMutex();
  ProcessMutex(const ProcessMutex&) = delete;
  ProcessMutex& operator=(const ProcessMutex&) = delete;

  void lock() { mutex_.lock(); }
  bool try_lock() { return mutex_.try_lock(); }
  void unlock() { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

}  // namespace mottle
