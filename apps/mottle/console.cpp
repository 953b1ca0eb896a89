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
  if (has_open_line_) tell("\n");
  has_open_line_ = false;
}

void Console::progress(const std::string& stage, std::int64_t done, std::int64_t total) {
  if (is_quiet_) return;
  const double now = steady_seconds();
  if (stage != stage_) {
    stage_ = stage;
    start_ = now;
    last_shown_ = now;  // a stage that is over at once needs no progress
  }
  const double interval = is_terminal_ ? k_terminal_interval_s : k_plain_interval_s;
  if (now - last_shown_ < interval) return;
  last_shown_ = now;
  const double rate = static_cast<double>(done) / (now - start_);
  const double left = rate > 0.0 ? static_cast<double>(total - done) / rate : 0.0;
  const std::string text =
      fmt::format("{}: {} of {}, {:.3g} a second, at most {:.0f} s left", stage, done, total, rate, left);
  if (is_terminal_) {
    tell(fmt::format("\r\033[K{}", text));
    std::fflush(stderr);
    has_open_line_ = true;
  } else {
    tell(text + "\n");
  }
}

void Console::warning(const std::string& text) {
  end_line();
  if (!is_quiet_) tell(fmt::format("mottle: warning: {}\n", printable(text)));
}

void Console::note(const std::string&) {}  // notes are for the log; the summary says what matters

}  // namespace mottle::app
