#include "mottle/core/process_mutex.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <mutex>
#include <thread>

namespace mottle {
namespace {

/// Exit code of a forked process that takes both: 0, or 99 after 20 s without them.
int code_of_child(ProcessMutex& first, ProcessMutex& second, const int& changes) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGALRM, [](int /*signal*/) { ::_exit(99); });
    ::alarm(20);
    const std::lock_guard one(first);
    const std::lock_guard other(second);
    ::_exit(changes % 2);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

TEST(ProcessMutex, IsFreeInAForkedProcessAndWhatItGuardsIsWhole) {
  ProcessMutex first;
  ProcessMutex second;
  int changes = 0;  // even while nobody holds both
  std::atomic<bool> is_done = false;
  std::thread other([&] {
    while (!is_done) {
      const std::lock_guard outer(second);  // the later one first
      const std::lock_guard inner(first);
      ++changes;
      std::this_thread::sleep_for(std::chrono::microseconds(300));
      ++changes;
    }
  });
  for (int fork = 0; fork < 100; ++fork) ASSERT_EQ(code_of_child(first, second, changes), 0) << "fork " << fork;
  is_done = true;
  other.join();
}

}  // namespace
}  // namespace mottle
