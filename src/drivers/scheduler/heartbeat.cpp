#include "drivers/scheduler/heartbeat.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <random>

#include "drivers/command/run_output.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/ranks.hpp"

namespace mottle::drivers {
namespace {

constexpr const char* k_alive = "alive";
constexpr const char* k_given_up = "given-up";

/// What the beat of that number writes, of the same length each time.
std::string words_of_beat(unsigned id, int count) {
  return fmt::format("{:10} {:08x} {}\n", count, id, node_name());
}

/// Of the same size each time, in place: a full disk does not end it. Opened anew: network file systems hand on what
/// was written when a file is closed.
///
/// @param flags  O_EXCL: only where there is no such file. 0, or errno
int beat(const std::filesystem::path& file, unsigned id, int count, int flags = 0) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC | flags, 0644);
  if (descriptor < 0) return errno;
  const std::string text = words_of_beat(id, count);
  const int error = ::pwrite(descriptor, text.data(), text.size(), 0) < 0 ? errno : 0;
  ::close(descriptor);
  return error;
}

/// Makes the file of a process whose beats the others will see, where nobody else beats. Of several at the same time
/// one makes a file that is not there; where a dead process has left one, all write to it, and the last of them finds
/// its own words there. One that was held up between its look and its words finds beats of the other there.
bool claim(const std::filesystem::path& task, unsigned id, std::chrono::milliseconds interval) {
  const std::filesystem::path file = task / k_alive;
  if (beat(file, id, 0, O_EXCL) != EEXIST) return true;  // where there is no room it works without, here and below
  const std::string before = read_heartbeat(task);
  std::this_thread::sleep_for(2 * interval + interval / 2);
  if (read_heartbeat(task) != before) return false;
  if (beat(file, id, 0) != 0) return true;
  std::this_thread::sleep_for(interval + interval / 2);
  return read_heartbeat(task).starts_with(words_of_beat(id, 0));  // the other's words may have been longer
}

}  // namespace

std::unique_ptr<Heartbeat> Heartbeat::begin(const std::filesystem::path& task, std::chrono::milliseconds interval) {
  const unsigned id = std::random_device()();
  if (!claim(task, id, interval)) return nullptr;
  return std::unique_ptr<Heartbeat>(new Heartbeat(task / k_alive, id, interval));
}

Heartbeat::Heartbeat(std::filesystem::path file, unsigned id, std::chrono::milliseconds interval)
    : file_(std::move(file)) {
  beat(file_, id, 1);
  thread_ = std::jthread([file = file_, id, interval](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock<std::mutex> lock(mutex);
    for (int count = 2; !bell.wait_for(lock, stop, interval, [&] { return stop.stop_requested(); }); ++count) {
      beat(file, id, count);
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
