#include "console.hpp"

#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <string_view>

#include "mottle/core/utf8.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::app {
namespace {

constexpr double k_first_plain_s = 1.0;  // a silent start looks like a hang
constexpr double k_plain_interval_s = 10.0;
constexpr double k_terminal_interval_s = 0.1;

static_assert(std::atomic<bool>::is_always_lock_free, "the signal handler needs it");

/// Ends Mottle where a stop request was not answered in time, in a long factorisation say: what is on the disk is
/// whole, the journal goes as far as it goes, and guards end their solvers.
void end_now(int) {
  constexpr std::string_view k_text = "mottle: stopped on request; go on with --resume\n";
  (void)!::write(STDERR_FILENO, k_text.data(), k_text.size());
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

/// "40 s", "9 min", "2.5 h".
std::string duration_text(double seconds) {
  constexpr double k_minute = 60.0;
  constexpr double k_hour = 3600.0;
  if (seconds < 2.0 * k_minute) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * k_hour) return fmt::format("{:.0f} min", seconds / k_minute);
  return fmt::format("{:.1f} h", seconds / k_hour);
}

}  // namespace

void tell(const std::string& text) {
  (void)std::fputs(text.c_str(), stderr);
}

std::atomic<bool>& stop_flag() {
  static std::atomic<bool> flag{false};
  return flag;
}

void catch_signals() {
  stop_flag();
  std::signal(SIGALRM, end_now);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal_number, request_stop);
  // A file beyond the allowed size is an error of that write, not the end. (An ignored signal would be so in solvers
  // too.)
  std::signal(SIGXFSZ, [](int) {});
}

Console::Console(bool is_quiet) : is_quiet_(is_quiet), is_terminal_(::isatty(STDERR_FILENO) == 1) {}

Console::~Console() {
  end_line();
}

void Console::end_line() {
  if (has_open_line_) tell("\r\033[K");
  has_open_line_ = false;
}

void Console::begin(const std::string& phase) {
  if (is_terminal_ && !is_quiet_) show(phase + " ...");
}

void Console::show(const std::string& text) {
  tell(fmt::format("\r\033[K{}", text));
  std::fflush(stderr);
  has_open_line_ = true;
}

void Console::progress(const std::string& stage, std::int64_t done, std::int64_t total) {
  if (is_quiet_) return;
  const double now = steady_seconds();
  if (stage != stage_) {
    stage_ = stage;
    start_ = now;
    last_shown_ = now;  // a stage that is over at once needs no progress
    interval_ = is_terminal_ ? k_terminal_interval_s : k_first_plain_s;
  }
  if (now - last_shown_ < interval_) return;
  last_shown_ = now;
  if (!is_terminal_) interval_ = k_plain_interval_s;
  std::string text = fmt::format("{}: {} of {}", stage, done, total);
  const double elapsed = now - start_;
  if (done > 0 && elapsed > 0.0) {
    const double rate = static_cast<double>(done) / elapsed;
    text += fmt::format(", {:.3g} a second", rate);
    if (const double left = static_cast<double>(total - done) / rate; left >= 1.0) {
      text += fmt::format(", at most {} left at this rate", duration_text(left));
    }
  }
  if (is_terminal_) {
    show(text);
  } else {
    tell(text + "\n");
  }
}

void Console::warning(const std::string& text) {
  end_line();
  if (!is_quiet_) tell(fmt::format("mottle: warning: {}\n", printable(text)));
}

void Console::note(const std::string&) {}  // notes are for the log; the summary says what matters

void Console::finding(const std::string& text) {
  end_line();
  if (!is_quiet_) tell(printable(text) + "\n");
}

}  // namespace mottle::app
