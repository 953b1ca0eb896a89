// What keeps a process from being forked while its threads change what all of them share. A forked process has none of
// the other threads of the first one: a mutex that one of them held would never be unlocked there, a static object that
// one was making never be made. So a fork (by fork(), as Python's multiprocessing starts processes; not by
// posix_spawn()) waits until no other thread holds one of these.
#pragma once

#include <atomic>

namespace mottle {

/// No other thread forks while one of these lives. It goes before a function's static object that takes long to make,
/// and around calls of a library that has locks of its own: a process that is forked meanwhile would wait there for
/// ever, for a thread that it does not have. Whoever holds one waits for no other thread that may ask for one (starts
/// no parallel_for()), since such a thread waits where a fork waits.
class NoFork {
 public:
  NoFork();
  ~NoFork();
  NoFork(const NoFork&) = delete;
  NoFork& operator=(const NoFork&) = delete;

  /// What an object of this class does, for those who cannot have one; each begin() is ended by the same thread.
  static void begin();
  static void end();
};

/// A mutex for static objects; no other thread forks while it is held. Unlocked by the thread that locked it, and not
/// asked for while another mutex is held that is asked for within it.
class ProcessMutex {
 public:
  constexpr ProcessMutex() = default;
  void lock();
  void unlock();

 private:
  std::atomic<int> is_held_ = 0;
};

}  // namespace mottle
