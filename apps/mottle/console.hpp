// What the user sees while a run goes on, and how signals become a stop request.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "progress_line.hpp"

namespace mottle::app {

/// Progress on stderr: one line that is rewritten on a terminal; plain lines elsewhere, the first within a second. A
/// thread of its own keeps it alive where a long step reports nothing.
class Console final : public ProgressObserver {
 public:
  explicit Console(bool is_quiet);
  ~Console() override;
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// What the command itself does beside its job.
  void begin(const std::string& name) { phase({.name = name}); }
  /// Nothing more is shown, and the line of progress is taken away.
  void finish();

  void phase(const Phase& next) override;
  void progress(const std::string& work, std::int64_t done, std::int64_t total) override;
  void detail(const std::string& text) override;
  void warning(const std::string& text) override;
  void note(const std::string& text) override;
  void finding(const std::string& text) override;

 private:
  void keep_alive(const std::stop_token& stop);
  void show_if_due();
  void erase_line();
  void say(const std::string& line);

  bool is_quiet_;
  bool is_terminal_;
  std::mutex mutex_;  // of all below
  ProgressLine line_;
  bool has_open_line_ = false;
  double next_shown_ = 0.0;
  std::condition_variable_any changed_;
  std::jthread ticker_;  // last: it ends before what it uses
};

/// Writes to standard error; one that takes nothing changes nothing else. Ranks but the first write nothing.
void tell(const std::string& text);

/// The exit code of a job that was stopped on request.
inline constexpr int k_stopped = 4;

/// Set by SIGINT, SIGTERM and SIGHUP.
std::atomic<bool>& stop_flag();

/// From now on those signals ask for a stop; where none comes within 0.9 s, or at a second signal, the program ends at
/// once, and what it has finished stays for --resume.
void catch_signals();
/// What is said where a stop was asked for and not answered in time; a line that stays as long as the program.
void say_when_stopped(const char* text);
/// The job is at its end: a stop that was asked for and not answered in time ends nothing any more.
void no_longer_stop();

}  // namespace mottle::app
