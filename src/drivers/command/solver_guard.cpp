#include "drivers/command/solver_guard.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

// The kernel signals Mottle's death to it (PR_SET_PDEATHSIG). Guard and program start in copies of a process with many
// threads and call nothing but what is safe there; hence _Fork, which runs no handlers of libraries, and strings that
// are made before.

namespace mottle::drivers {
namespace {

int open_new(const char* file) {
  return ::open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
}

/// In the program's process: becomes the program, or returns why not.
int become(const ProgramStart& start, pid_t guard) {
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

[[noreturn]] void tell(int pipe, const GuardMessage& message) {
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

}  // namespace

void guard(const ProgramStart& start, int pipe, pid_t mottle, std::chrono::milliseconds grace) {
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
  GuardMessage message;
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
  const timespec now{0, 0};
  sigdelset(&awaited, SIGCHLD);
  message.is_asked = is_asked || ::sigtimedwait(&awaited, nullptr, &now) == SIGTERM;
  tell(pipe, message);
}

}  // namespace mottle::drivers
