// What keeps a process from being forked while its threads change what all of them share. A forked process has none of
// the other threads of the first one: a mutex that one of them held would never be unlocked there, a static object that
// one was making never be made. So a fork (by fork(), as Python's multiprocessing starts processes; not by
// posix_spawn()) waits until no other thread holds one of these.
#pragma once

#include <mutex>

namespace mottle {

/// No other thread forks while one of these lives. It goes before a function's static object that takes long to make:
/// a process that is forked meanwhile would wait there for ever, for a thread that it does not have.
class NoFork {
 public:
  NoFork();
  ~NoFork();
  NoFork(const NoFork&) = delete;
  NoFork& operator=(const NoFork&) = delete;
};

/// A mutex for static objects; no other thread forks while it is held.
class ProcessMutex {
 public:
  constexpr ProcessMutex() = default;
  void lock();
  void unlock();

 private:
  std::mutex mutex_;
};

}  // namespace mottle
