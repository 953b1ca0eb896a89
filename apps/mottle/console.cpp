#include "console.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <string_view>
#include <system_error>

#include "job_ranks.hpp"
#include "mottle/core/clock.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::app {
namespace {

constexpr double k_first_plain_s = 0.8;  // a silent start looks like a hang
constexpr double k_plain_interval_s = 10.0;
constexpr double k_terminal_interval_s = 0.1;
constexpr std::chrono::milliseconds k_tick{100};

static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free,
              "the signal handler needs them");

/// What the handler says.
std::atomic<const char*>& stop_text() {
  static std::atomic<const char*> text{"mottle: stopped on request; go on with --resume\n"};
  return text;
}

/// Ends Mottle where a stop request was not answered in time, in a long factorisation say: what is on the disk is
/// whole, the journal goes as far as it goes, and guards end their solvers.
void end_now(int) {
  const std::string_view text = stop_text().load();
  if (!is_silent_rank()) (void)!::write(STDERR_FILENO, text.data(), text.size());
  ::_exit(k_stopped);
}

void request_stop(int signal_number) {
  if (stop_flag().exchange(true)) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
  const itimerval patience{.it_interval = {0, 0}, .it_value = {0, 900'000}};
  ::setitimer(ITIMER_REAL, &patience, nullptr);
}

/// A longer line would be wrapped, and only its last part could be taken away again.
std::size_t terminal_width() {
  constexpr std::size_t k_usual = 80;
  winsize size{};
  const bool is_known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return is_known ? size.ws_col : k_usual;
}

}  // namespace

void tell(const std::string& text) {
  if (is_silent_rank()) return;
  (void)std::fputs(text.c_str(), stderr);
}

std::atomic<bool>& stop_flag() {
  static std::atomic<bool> flag{false};
  return flag;
}

void say_when_stopped(const char* text) {
  stop_text() = text;
}

void no_longer_stop() {
  const itimerval none{};
  ::setitimer(ITIMER_REAL, &none, nullptr);
}

void catch_signals() {
  stop_flag();
  stop_text();
  (void)is_silent_rank();  // known before a handler asks
  std::signal(SIGALRM, end_now);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal_number, request_stop);
  // A file beyond the allowed size is an error of that write, not the end. (An ignored signal would be so in solvers
  // too.)
  std::signal(SIGXFSZ, [](int) {});
}

Console::Console(bool is_quiet)
    : is_quiet_(is_quiet),
      is_terminal_(::isatty(STDERR_FILENO) == 1),
      next_shown_(is_terminal_ ? 0.0 : steady_seconds() + k_first_plain_s) {
  if (is_quiet_) return;
  sigset_t all{};
  sigset_t before{};
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);  // a signal is to interrupt what the main thread waits in
  try {
    ticker_ = std::jthread([this](const std::stop_token& stop) { keep_alive(stop); });
  } catch (const std::system_error&) {  // no more threads: what reports is shown all the same
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Console::~Console() {
  finish();
}

void Console::finish() {
  if (ticker_.joinable()) {
    ticker_.request_stop();
    ticker_.join();
  }
  const std::lock_guard lock(mutex_);
  erase_line();
}

void Console::keep_alive(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait_for(lock, stop, k_tick, [] { return false; });
    if (!stop.stop_requested()) show_if_due();
  }
}

void Console::erase_line() {
  if (has_open_line_) tell("\r\033[K");
  has_open_line_ = false;
}

void Console::show_if_due() {
  const double now = steady_seconds();
  if (is_quiet_ || now < next_shown_) return;
  const std::string text = printable(line_.text(now));
  if (text.empty()) return;
  next_shown_ = now + (is_terminal_ ? k_terminal_interval_s : k_plain_interval_s);
  if (is_terminal_) {
    tell(fmt::format("\r\033[K{}", text.substr(0, terminal_width() - 1)));
    has_open_line_ = true;
  } else {
    tell(text + "\n");
  }
}

void Console::phase(const Phase& next) {
  const std::lock_guard lock(mutex_);
  line_.begin(next, steady_seconds());
  show_if_due();
}

void Console::progress(const std::string& work, std::int64_t done, std::int64_t total) {
  const std::lock_guard lock(mutex_);
  line_.count(work, done, total, steady_seconds());
  show_if_due();
}

void Console::detail(const std::string& text) {
  const std::lock_guard lock(mutex_);
  line_.set_detail(text);
  show_if_due();
}

void Console::say(const std::string& line) {
  if (is_quiet_) return;
  const std::lock_guard lock(mutex_);
  erase_line();
  tell(line + "\n");
}

void Console::warning(const std::string& text) {
  say("mottle: warning: " + printable(text));
}

void Console::note(const std::string&) {}  // notes are for the log; the summary says what matters

void Console::finding(const std::string& text) {
  say(printable(text));
}

}  // namespace mottle::app
