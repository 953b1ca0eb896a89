#include "drivers/command/solver_guard.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

#include "mottle/core/error.hpp"

// The kernel signals Mottle's death to it (PR_SET_PDEATHSIG). Guard and program start in copies of a process with many
// threads and call nothing but what is safe there; hence _Fork, which runs no handlers of libraries, and requests that
// are used where they lie. Programs are started by vfork: of a guard that is a copy of a large Mottle no copy is made.

namespace mottle::drivers {
namespace {

/// What comes first of a request; the strings follow, each with a zero at its end.
struct RequestHead {
  std::uint64_t bytes = 0;  ///< of the strings
  std::uint64_t arguments = 0;
  std::uint64_t environment = 0;
  std::int64_t grace_ms = 0;
};

/// A request as the guard has it, in memory that it shares with the program's process until that is the program.
struct Request {
  void* memory = nullptr;
  std::size_t size = 0;
  volatile int* start_error = nullptr;  ///< of the program's process
  const char* program = nullptr;
  const char* directory = nullptr;
  const char* output = nullptr;
  const char* error = nullptr;
  char** arguments = nullptr;
  char** environment = nullptr;
  timespec grace = {};
};

bool read_all(int socket, void* destination, std::size_t size) {
  auto* bytes = static_cast<char*>(destination);
  while (size > 0) {
    const ssize_t got = ::read(socket, bytes, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

/// Moves to the string behind.
char* next_text(char* text) {
  return text + std::strlen(text) + 1;
}

/// Waits for a request; false: there will be none any more.
bool receive(int socket, Request& request) {
  RequestHead head;
  if (!read_all(socket, &head, sizeof(head))) return false;
  const std::size_t pointers = (1 + head.arguments + head.environment + 2) * sizeof(char*);
  request.size = pointers + head.bytes;
  request.memory = ::mmap(nullptr, request.size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (request.memory == MAP_FAILED) return false;
  char* text = static_cast<char*>(request.memory) + pointers;
  if (!read_all(socket, text, head.bytes)) return false;
  for (const char** name : {&request.program, &request.directory, &request.output, &request.error}) {
    *name = text;
    text = next_text(text);
  }
  request.start_error = static_cast<int*>(request.memory);
  request.arguments = static_cast<char**>(request.memory) + 1;
  request.environment = request.arguments + head.arguments + 1;
  for (std::uint64_t i = 0; i < head.arguments; ++i, text = next_text(text)) request.arguments[i] = text;
  for (std::uint64_t i = 0; i < head.environment; ++i, text = next_text(text)) request.environment[i] = text;
  request.grace = {head.grace_ms / 1000, head.grace_ms % 1000 * 1000000};
  return true;  // both lists end with a null, as new memory is zero
}

/// Ends this process without a word of ThreadSanitizer's, whose _exit takes a second to judge a copy of Mottle.
[[noreturn]] void leave(int status) {
  for (;;) ::syscall(SYS_exit_group, status);
}

int open_new(const char* file) {
  return ::open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
}

/// In the program's process: becomes the program, or returns why not.
int become(const Request& start, pid_t guard) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != guard) leave(1);
  if (::chdir(start.directory) != 0) return errno;
  const int input = ::open("/dev/null", O_RDONLY);
  const int output = open_new(start.output);
  const int error = open_new(start.error);
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
    ::execve(start.program, start.arguments, start.environment);
    if (errno != ETXTBSY) break;
    ::nanosleep(&moment, nullptr);
  }
  return errno;
}

void tell(int socket, const GuardMessage& message) {
  // Mottle may be gone.
  [[maybe_unused]] const ssize_t written = ::send(socket, &message, sizeof(message), MSG_NOSIGNAL);
}

/// Ends what the program has left behind, in whatever session: its orphans are the guard's children.
void kill_orphans() {
  constexpr int k_max_rounds = 5000;  // each ends one generation
  const timespec moment{0, 2'000'000};
  for (int round = 0; round < k_max_rounds; ++round) {
    pid_t ended = 0;
    while ((ended = ::waitpid(-1, nullptr, WNOHANG)) > 0) {
    }
    if (ended < 0) return;  // there are none, as mostly
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
    ::nanosleep(&moment, nullptr);
  }
}

/// Whether Mottle's SIGTERM is there, which it then no longer is.
bool take_request_to_end() {
  sigset_t awaited;
  sigemptyset(&awaited);
  sigaddset(&awaited, SIGTERM);
  const timespec now{0, 0};
  return ::sigtimedwait(&awaited, nullptr, &now) == SIGTERM;
}

/// Waits for the end of a program, and ends it where that is asked for; whether it was.
bool await_program(pid_t program, const timespec& grace, int& wait_status) {
  sigset_t awaited;
  sigemptyset(&awaited);
  sigaddset(&awaited, SIGCHLD);
  sigaddset(&awaited, SIGTERM);
  bool is_asked = false;
  while (::waitpid(program, &wait_status, WNOHANG) == 0) {
    const int number = ::sigtimedwait(&awaited, nullptr, is_asked ? &grace : nullptr);
    if (number == SIGTERM && !is_asked) {
      ::kill(-program, SIGTERM);
      ::kill(-program, SIGCONT);
      is_asked = true;
    } else if (number == SIGTERM || (number < 0 && errno == EAGAIN)) {
      ::kill(-program, SIGKILL);
    }
  }
  return is_asked;
}

/// Runs a program to its end, with all that it leaves behind.
GuardMessage run(const Request& request) {
  if (take_request_to_end()) return {.is_asked = true};
  const pid_t self = ::getpid();
#ifdef __SANITIZE_THREAD__  // whose vfork is a fork with handlers
  const pid_t program = ::_Fork();
#else
  const pid_t program = ::vfork();
#endif
  if (program == 0) {
    *request.start_error = become(request, self);
    leave(1);
  }
  if (program < 0) return {.start_error = errno};
  GuardMessage message;
  const bool is_asked = await_program(program, request.grace, message.wait_status);
  ::kill(-program, SIGKILL);
  kill_orphans();
  message.start_error = *request.start_error;
  message.is_asked = take_request_to_end() || is_asked;
  return message;
}

}  // namespace

std::string guard_request(const ProgramStart& start) {
  RequestHead head{
      .arguments = start.arguments.size(), .environment = start.environment.size(), .grace_ms = start.grace.count()};
  std::string bytes(sizeof(head), '\0');
  const auto add = [&](const std::string& text) { bytes.append(text.c_str()).push_back('\0'); };
  for (const std::string* text : {&start.program, &start.directory, &start.output, &start.error}) add(*text);
  for (const std::string& text : start.arguments) add(text);
  for (const std::string& text : start.environment) add(text);
  head.bytes = bytes.size() - sizeof(head);
  std::memcpy(bytes.data(), &head, sizeof(head));
  return bytes;
}

void guard(int socket, pid_t mottle) {
  sigset_t all;
  sigfillset(&all);
  ::sigprocmask(SIG_SETMASK, &all, nullptr);
  ::signal(SIGCHLD, SIG_DFL);
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  if (::getppid() != mottle) leave(1);
  // A file that another thread is writing, held open here, could not be run.
  ::close_range(3, static_cast<unsigned>(socket) - 1, 0);
  ::close_range(static_cast<unsigned>(socket) + 1, ~0U, 0);
  for (Request request; receive(socket, request);) {
    tell(socket, run(request));
    ::munmap(request.memory, request.size);
  }
  leave(0);
}

GuardProcess::GuardProcess() {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw SystemFailure(fmt::format("no socket: {}", std::strerror(errno)));
  }
  socket_ = ends[0];
  const pid_t mottle = ::getpid();
  id_ = ::_Fork();
  if (id_ == 0) guard(ends[1], mottle);
  const int error = errno;
  ::close(ends[1]);
  if (id_ > 0) return;
  ::close(socket_);
  throw SystemFailure(fmt::format("no process can be started: {}", std::strerror(error)));
}

GuardProcess::~GuardProcess() {
  ::shutdown(socket_, SHUT_RDWR);  // a process that is just being forked may have it open, too
  ::close(socket_);
  while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool GuardProcess::send(const std::string& request) const {
  std::string_view rest = request;
  while (!rest.empty()) {
    const ssize_t sent = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return false;
    rest.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace mottle::drivers
