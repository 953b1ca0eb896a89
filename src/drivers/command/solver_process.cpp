#include "mottle/drivers/command/solver_process.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "drivers/command/solver_guard.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/launcher.hpp"

namespace mottle::drivers {
namespace {

using Clock = std::chrono::steady_clock;

/// Of this thread; null: each program has a guard of its own.
thread_local std::unique_ptr<GuardProcess>* shared_guard = nullptr;

std::vector<std::string> environment_texts(const std::map<std::string, std::string>& added) {
  const bool is_rank = find_launch().is_shared();
  std::vector<std::string> texts;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text(*entry);
    const std::string name = text.substr(0, text.find('='));
    if (!added.contains(name) && !(is_rank && is_launch_variable(name))) texts.push_back(text);
  }
  for (const auto& [name, value] : added) texts.push_back(fmt::format("{}={}", name, value));
  return texts;
}

ProcessEnd describe(const GuardMessage& message, const ProcessRequest& request) {
  if (message.start_error != 0) {
    return {.reason = fmt::format("'{}' cannot be started: {}", request.arguments.front(),
                                  std::strerror(message.start_error))};
  }
  const int status = message.wait_status;
  if (WIFSIGNALED(status)) {
    return {.reason = fmt::format("killed by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)))};
  }
  if (WEXITSTATUS(status) != 0) return {.reason = fmt::format("exit status {}", WEXITSTATUS(status))};
  return {.kind = ProcessEnd::Kind::done};
}

/// Whether a program that Mottle did not ask to end may have been ended from outside. Shells give the number of a
/// signal as 128 + n.
bool may_be_ended_from_outside(const GuardMessage& message) {
  const int status = message.wait_status;
  int number = 0;
  if (WIFSIGNALED(status)) number = WTERMSIG(status);
  if (WIFEXITED(status)) number = WEXITSTATUS(status) - 128;
  return message.is_asked || number == SIGTERM || number == SIGKILL || number == SIGINT || number == SIGHUP;
}

/// Waits a second for a stop request. A batch system that ends a job (at its time limit, say) signals all processes of
/// it, one by one, and the program before Mottle: such an end says nothing of the sample.
bool is_soon_stopped(const ProcessRequest& request) {
  constexpr std::chrono::milliseconds k_between_looks{5};
  const Clock::time_point end = Clock::now() + std::chrono::seconds(1);
  const auto is_stopped = [&] { return request.stop != nullptr && request.stop->load(std::memory_order_relaxed); };
  while (request.stop != nullptr && !is_stopped() && Clock::now() < end) std::this_thread::sleep_for(k_between_looks);
  return is_stopped();
}

/// The end of a program that Mottle did not ask for. `size`: of the guard's message; 0: it died before that.
ProcessEnd unasked_end(const GuardMessage& message, ssize_t size, const ProcessRequest& request) {
  const bool is_told = size == sizeof(message);
  if ((!is_told || may_be_ended_from_outside(message)) && is_soon_stopped(request)) return {ProcessEnd::Kind::stopped};
  if (!is_told) return {ProcessEnd::Kind::lost, "its guard was killed from outside"};
  if (message.is_asked) return {ProcessEnd::Kind::lost, "its guard was asked from outside to end it"};
  return describe(message, request);
}

/// Whether next to nothing can be written on a folder's file system.
bool is_full(const std::filesystem::path& folder) {
  constexpr std::uint64_t k_next_to_nothing = 1 << 16;
  struct statvfs room {};
  if (::statvfs(folder.c_str(), &room) != 0 || room.f_blocks == 0) return false;
  return std::uint64_t{room.f_bavail} * room.f_frsize < k_next_to_nothing || (room.f_files > 0 && room.f_favail == 0);
}

/// The file that holds more than a program may print; nullptr: none does.
const char* flooded_file(const ProcessRequest& request) {
  for (const char* name : {k_standard_output, k_standard_error}) {
    struct stat status {};
    const bool is_there = ::lstat((request.directory / name).c_str(), &status) == 0 && S_ISREG(status.st_mode);
    if (is_there && static_cast<std::uintmax_t>(status.st_size) > request.max_output) return name;
  }
  return nullptr;
}

/// Waits for the guard's message, and asks it for an early end where that is due.
ProcessEnd await_end(const GuardProcess& guard, const ProcessRequest& request) {
  constexpr std::chrono::milliseconds k_between_looks{100};
  constexpr std::chrono::milliseconds k_patience_of_a_stop{500};
  const Clock::time_point deadline = Clock::now() + request.timeout;
  Clock::time_point asked;
  ProcessEnd early{.kind = ProcessEnd::Kind::done};
  GuardMessage message;
  bool was_full = false;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    const bool is_early = early.kind != ProcessEnd::Kind::done;
    pollfd ready{.fd = guard.socket(), .events = POLLIN, .revents = 0};
    const auto wait = is_early ? k_between_looks : std::clamp(left, std::chrono::milliseconds(0), k_between_looks);
    if (::poll(&ready, 1, static_cast<int>(wait.count())) > 0) {
      const ssize_t size = ::read(guard.socket(), &message, sizeof(message));
      if (size < 0 && errno == EINTR) continue;
      ProcessEnd end = is_early ? early : unasked_end(message, size, request);
      end.was_full = was_full || is_full(request.directory);
      return end;
    }
    was_full = was_full || is_full(request.directory);
    if (is_early) {
      // A stop request is answered within a second, whatever the program does.
      if (early.kind == ProcessEnd::Kind::stopped && Clock::now() > asked + k_patience_of_a_stop) {
        ::kill(guard.id(), SIGTERM);
      }
      continue;
    }
    if (request.stop != nullptr && request.stop->load(std::memory_order_relaxed)) {
      early.kind = ProcessEnd::Kind::stopped;
    } else if (left <= std::chrono::milliseconds(0)) {
      early = {ProcessEnd::Kind::timed_out,
               fmt::format("no end within {} s, stopped", static_cast<double>(request.timeout.count()) / 1000.0)};
    } else if (const char* file = flooded_file(request)) {
      early = {ProcessEnd::Kind::failed,
               fmt::format("it printed more than {} MB to {}, stopped", request.max_output >> 20U, file)};
    }
    if (early.kind == ProcessEnd::Kind::done) continue;
    asked = Clock::now();
    ::kill(guard.id(), SIGTERM);
  }
}

}  // namespace

ProcessSeries::ProcessSeries() : before_(std::exchange(shared_guard, &guard_)) {}

ProcessSeries::~ProcessSeries() {
  shared_guard = before_;
}

ProcessEnd run_process(const ProcessRequest& request) {
  ProgramStart start{.program = find_program(request.arguments.front()).string(),
                     .directory = request.directory.string(),
                     .output = k_standard_output,
                     .error = k_standard_error,
                     .arguments = request.arguments,
                     .environment = environment_texts(request.environment),
                     .grace = request.grace};
  if (start.program.empty()) start.program = request.arguments.front();
  const std::string bytes = guard_request(start);
  std::unique_ptr<GuardProcess> own;
  std::unique_ptr<GuardProcess>& guard = shared_guard != nullptr ? *shared_guard : own;
  if (!guard || !guard->send(bytes)) {  // one that was killed between two programs has harmed none
    guard.reset();
    guard = std::make_unique<GuardProcess>();
    guard->send(bytes);  // where that fails, the guard is lost
  }
  ProcessEnd end = await_end(*guard, request);
  // Where it was to end a program, a signal may still be on its way.
  if (end.kind != ProcessEnd::Kind::done) guard.reset();
  return end;
}

std::filesystem::path find_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return name;
  const char* path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "/usr/bin:/bin";
  while (!rest.empty() && !name.empty()) {
    const std::size_t colon = rest.find(':');
    const std::filesystem::path candidate = std::filesystem::path(rest.substr(0, colon)) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(candidate, ignored) && ::access(candidate.c_str(), X_OK) == 0) {
      return std::filesystem::absolute(candidate);
    }
    rest = colon == std::string_view::npos ? "" : rest.substr(colon + 1);
  }
  return {};
}

}  // namespace mottle::drivers
