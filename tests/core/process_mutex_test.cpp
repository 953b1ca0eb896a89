#include "mottle/core/process_mutex.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace mottle {
namespace {

/// What `action` gives in a forked process; -1 where a signal ends it, as SIGALRM does after 20 s.
int code_of_child(const std::function<int()>& action) {
  const pid_t child = ::fork();
  if (child == -1) return -1;
  if (child == 0) {
    ::alarm(20);
    ::_exit(action());
  }
  int status = 0;
  if (::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

/// Threads that do this again and again while it lives.
class Busy {
 public:
  Busy(int count, const std::function<void()>& action) {
    for (int i = 0; i < count; ++i) {
      threads_.emplace_back([this, action] {
        while (!is_done_) action();
      });
    }
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;
  ~Busy() { is_done_ = true; }

 private:
  std::atomic<bool> is_done_ = false;
  std::vector<std::jthread> threads_;
};

void pause() {
  std::this_thread::sleep_for(std::chrono::microseconds(300));
}

constinit ProcessMutex first;
constinit ProcessMutex second;

TEST(ProcessMutex, IsFreeInAForkedProcessAndWhatItGuardsIsWhole) {
  int changes = 0;  // even while nobody holds both
  const Busy busy(1, [&] {
    const std::lock_guard outer(second);
    const std::lock_guard inner(first);
    ++changes;
    pause();
    ++changes;
  });
  for (int fork = 0; fork < 100; ++fork) {
    const int code = code_of_child([&] {
      const std::lock_guard one(first);
      const std::lock_guard other(second);
      return changes % 2;
    });
    ASSERT_EQ(code, 0) << "fork " << fork;
  }
}

TEST(ProcessMutex, HeldByOtherThreadsInTurnWithoutAPauseLetsForksThrough) {
  const auto hold = [](ProcessMutex& mutex) {
    const std::lock_guard lock(mutex);
    pause();
  };
  const Busy of_first(2, [&] { hold(first); });
  const Busy of_second(2, [&] { hold(second); });
  for (int fork = 0; fork < 100; ++fork) ASSERT_EQ(code_of_child([] { return 0; }), 0) << "fork " << fork;
}

TEST(ProcessMutex, KeepsAForkWaitingForThoseThatHaveItAndNotForThoseThatQueue) {
  std::atomic<int> turns = 0;
  const Busy busy(8, [&] {
    const std::lock_guard lock(first);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ++turns;
  });
  for (int fork = 0; fork < 10; ++fork) {
    const int before = turns;
    ASSERT_EQ(code_of_child([] {
                ::_exit(0);
                return 0;
              }),
              0);
    EXPECT_LE(turns - before, 5) << "of eight that hold it in turn";  // one or two, and those after the fork
  }
}

TEST(ProcessMutex, HeldByTheThreadThatForksIsHeldByItInTheForkedProcessToo) {
  const Busy busy(1, [&] { const std::lock_guard lock(second); });
  first.lock();
  EXPECT_EQ(code_of_child([] {
              first.unlock();
              const std::lock_guard again(first);
              return 0;
            }),
            0);
  first.unlock();
  EXPECT_EQ(code_of_child([] { return 0; }), 0);
}

int slow_static() {
  const NoFork no_fork;
  static const int value = [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return 7;
  }();
  return value;
}

TEST(NoFork, LetsAForkedProcessHaveAStaticObjectThatAnotherThreadWasMaking) {
  std::atomic<bool> has_begun = false;
  const std::jthread other([&] {
    has_begun = true;
    slow_static();
  });
  while (!has_begun) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(code_of_child([] { return slow_static() - 7; }), 0);
}

}  // namespace
}  // namespace mottle
