#include "drivers/scheduler/heartbeat.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>

#include "drivers/command/run_output.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/ranks.hpp"

namespace mottle::drivers {
namespace {

constexpr const char* k_alive = "alive";
constexpr const char* k_given_up = "given-up";

/// Of the same size each time, in place: a full disk does not end it. Opened anew: network file systems hand on what
/// was written when a file is closed.
void beat(const std::filesystem::path& file, int count) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (descriptor < 0) return;
  const std::string text = fmt::format("{:10} {:10} {}\n", count, ::getpid(), node_name());
  (void)!::pwrite(descriptor, text.data(), text.size(), 0);
  ::close(descriptor);
}

}  // namespace

Heartbeat::Heartbeat(const std::filesystem::path& task, std::chrono::milliseconds interval) : file_(task / k_alive) {
  beat(file_, 0);
  thread_ = std::jthread([file = file_, interval](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock<std::mutex> lock(mutex);
    for (int count = 1; !bell.wait_for(lock, stop, interval, [&] { return stop.stop_requested(); }); ++count) {
      beat(file, count);
    }
  });
}

Heartbeat::~Heartbeat() {
  thread_.request_stop();
  thread_.join();
  ::unlink(file_.c_str());
}

std::string read_heartbeat(const std::filesystem::path& task) {
  return last_part(task / k_alive);
}

bool is_beating(const std::filesystem::path& task, std::chrono::milliseconds interval) {
  const std::string before = read_heartbeat(task);
  if (before.empty()) return false;
  std::this_thread::sleep_for(2 * interval + interval / 2);
  const std::string after = read_heartbeat(task);
  return !after.empty() && after != before;
}

void give_up(const std::filesystem::path& task) {
  write_file_atomically(task / k_given_up, "Mottle waits no more for this task.\n");
}

void take_up(const std::filesystem::path& task) {
  ::unlink((task / k_given_up).c_str());
}

bool is_given_up(const std::filesystem::path& task) {
  std::error_code ignored;
  return std::filesystem::exists(task / k_given_up, ignored);
}

}  // namespace mottle::drivers
