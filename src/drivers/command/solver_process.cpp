#include "mottle/drivers/command/solver_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "mottle/core/error.hpp"
#include "mottle/core/launcher.hpp"

// Between Mottle and the program stands a guard: a process that waits for the program and, once Mottle asks or dies,
// ends the program's whole group. The kernel signals Mottle's death to it (PR_SET_PDEATHSIG). Guard and program start
// in copies of a process with many threads and call nothing but what is safe there; hence _Fork, which runs no handlers
// of libraries, and strings that are made before.

namespace mottle::drivers {
namespace {

using Clock = std::chrono::steady_clock;

/// Both ends of a pipe that no program inherits.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_, O_CLOEXEC) != 0) throw SystemFailure(fmt::format("no pipe: {}", std::strerror(errno)));
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    ::close(ends_[0]);
    close_writing();
  }
  int reading() const { return ends_[0]; }
  int writing() const { return ends_[1]; }
  void close_writing() {
    if (ends_[1] >= 0) ::close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
};

/// What the guard says at the end.
struct Message {
  int wait_status = 0;
  int start_error = 0;  ///< errno where the program could not be started
};

/// A program's start in plain pointers: nothing is allocated after the fork.
struct Start {
  std::vector<std::string> texts = {};
  std::vector<char*> arguments = {};
  std::vector<char*> environment = {};
  std::string program = {};
  std::string directory = {};
  std::string output = {};
  std::string error = {};
};

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

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

int open_new(const char* file) {
  return ::open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
}

/// In the program's process: becomes the program, or returns why not.
int become(const Start& start, pid_t guard) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != guard) ::_exit(1);
  if (::chdir(start.directory.c_str()) != 0) return errno;
  const int input = ::open("/dev/null", O_RDONLY);
  const int output = open_new(start.output.c_str());
  const int error = open_new(start.error.c_str());
  if (input < 0 || output < 0 || error < 0) return errno;
  if (::dup2(input, 0) < 0 || ::dup2(output, 1) < 0 || ::dup2(error, 2) < 0) return errno;
  for (const int descriptor : {input, output, error}) {
    if (descriptor > 2) ::close(descriptor);
  }
  for (const int number : {SIGPIPE, SIGINT, SIGQUIT, SIGTERM, SIGHUP}) ::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  // Another thread's guard may for a moment hold a file open that was just written and is to be run.
  constexpr int k_max_attempts = 200;
  const timespec moment{0, 5'000'000};
  for (int attempt = 0; attempt < k_max_attempts; ++attempt) {
    ::execve(start.program.c_str(), start.arguments.data(), start.environment.data());
    if (errno != ETXTBSY) break;
    ::nanosleep(&moment, nullptr);
  }
  return errno;
}

[[noreturn]] void tell(int pipe, const Message& message) {
  [[maybe_unused]] const ssize_t written = ::write(pipe, &message, sizeof(message));  // Mottle may be gone
  ::_exit(0);
}

/// Ends what the program has left behind, in whatever session: its orphans are the guard's children.
void kill_orphans() {
  constexpr int k_max_rounds = 5000;  // each ends one generation
  const timespec moment{0, 2'000'000};
  for (int round = 0; round < k_max_rounds; ++round) {
    const int list = ::open("/proc/thread-self/children", O_RDONLY | O_CLOEXEC);
    char text[4096];
    const ssize_t size = list < 0 ? 0 : ::read(list, text, sizeof(text));
    if (list >= 0) ::close(list);
    if (size <= 0) return;
    pid_t child = 0;
    for (ssize_t i = 0; i < size; ++i) {
      if (text[i] >= '0' && text[i] <= '9') {
        child = 10 * child + (text[i] - '0');
      } else {
        if (child > 0) ::kill(child, SIGKILL);
        child = 0;
      }
    }
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    ::nanosleep(&moment, nullptr);
  }
}

/// In the guard's process: starts the program and waits for its end. SIGTERM, of Mottle or of its death, ends the
/// group: first asked, after the grace or a second SIGTERM killed.
[[noreturn]] void guard(const Start& start, int pipe, pid_t mottle, std::chrono::milliseconds grace) {
  sigset_t all;
  sigfillset(&all);
  ::sigprocmask(SIG_SETMASK, &all, nullptr);
  ::signal(SIGCHLD, SIG_DFL);
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  if (::getppid() != mottle) ::_exit(1);
  // A file that another thread is writing, held open here, could not be run.
  ::close_range(3, static_cast<unsigned>(pipe) - 1, 0);
  ::close_range(static_cast<unsigned>(pipe) + 1, ~0U, 0);
  const pid_t self = ::getpid();
  const pid_t program = ::_Fork();
  if (program < 0) tell(pipe, {.start_error = errno});
  if (program == 0) tell(pipe, {.start_error = become(start, self)});
  ::setpgid(program, program);

  sigset_t awaited;
  sigemptyset(&awaited);
  sigaddset(&awaited, SIGCHLD);
  sigaddset(&awaited, SIGTERM);
  const timespec patience{grace.count() / 1000, grace.count() % 1000 * 1000000};
  bool is_asked = false;
  Message message;
  while (::waitpid(program, &message.wait_status, WNOHANG) == 0) {
    const int number = ::sigtimedwait(&awaited, nullptr, is_asked ? &patience : nullptr);
    if (number == SIGTERM && !is_asked) {
      ::kill(-program, SIGTERM);
      ::kill(-program, SIGCONT);
      is_asked = true;
    } else if (number == SIGTERM || (number < 0 && errno == EAGAIN)) {
      ::kill(-program, SIGKILL);
    }
  }
  ::kill(-program, SIGKILL);
  kill_orphans();
  tell(pipe, message);
}

ProcessEnd describe(const Message& message, const ProcessRequest& request) {
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
ProcessEnd await_end(const Pipe& pipe, pid_t guard_id, const ProcessRequest& request) {
  constexpr std::chrono::milliseconds k_between_looks{100};
  constexpr std::chrono::milliseconds k_patience_of_a_stop{500};
  const Clock::time_point deadline = Clock::now() + request.timeout;
  Clock::time_point asked;
  ProcessEnd early{.kind = ProcessEnd::Kind::done};
  Message message;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    const bool is_early = early.kind != ProcessEnd::Kind::done;
    pollfd ready{.fd = pipe.reading(), .events = POLLIN, .revents = 0};
    const auto wait = is_early ? k_between_looks : std::clamp(left, std::chrono::milliseconds(0), k_between_looks);
    if (::poll(&ready, 1, static_cast<int>(wait.count())) > 0) {
      const ssize_t size = ::read(pipe.reading(), &message, sizeof(message));
      if (size < 0 && errno == EINTR) continue;
      if (is_early) return early;
      return size == sizeof(message) ? describe(message, request)
                                     : ProcessEnd{.reason = "its guard was killed from outside"};
    }
    if (is_early) {
      // A stop request is answered within a second, whatever the program does.
      if (early.kind == ProcessEnd::Kind::stopped && Clock::now() > asked + k_patience_of_a_stop) {
        ::kill(guard_id, SIGTERM);
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
    ::kill(guard_id, SIGTERM);
  }
}

}  // namespace

ProcessEnd run_process(const ProcessRequest& request) {
  Start start{.texts = request.arguments};
  start.arguments = pointers(start.texts);
  std::vector<std::string> environment = environment_texts(request.environment);
  start.environment = pointers(environment);
  start.program = find_program(request.arguments.front()).string();
  if (start.program.empty()) start.program = request.arguments.front();
  start.directory = request.directory.string();
  start.output = k_standard_output;
  start.error = k_standard_error;
  Pipe pipe;
  const pid_t mottle = ::getpid();
  const pid_t guard_id = ::_Fork();
  if (guard_id < 0) throw SystemFailure(fmt::format("no process can be started: {}", std::strerror(errno)));
  if (guard_id == 0) guard(start, pipe.writing(), mottle, request.grace);
  pipe.close_writing();
  ProcessEnd end = await_end(pipe, guard_id, request);
  while (::waitpid(guard_id, nullptr, 0) < 0 && errno == EINTR) {
  }
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
