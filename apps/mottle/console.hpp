// What the user sees while a run goes on, and how signals become a stop request.
#pragma once

#include <atomic>
#include <string>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"

namespace mottle::app {

/// Progress on stderr: one line that is rewritten, with rate and time left, on a terminal; plain lines elsewhere.
class Console final : public ProgressObserver {
 public:
  explicit Console(bool is_quiet);
  ~Console() override;
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Says at once, on a terminal, what is being done before anything can be counted.
  void begin(const std::string& phase);
  /// Takes the line of progress away, before something else is printed.
  void end_line();

  void progress(const std::string& stage, std::int64_t done, std::int64_t total) override;
  void warning(const std::string& text) override;
  void note(const std::string& text) override;
  void finding(const std::string& text) override;

 private:
  void show(const std::string& text);
  bool is_quiet_;
  bool is_terminal_;
  bool has_open_line_ = false;
  double start_ = 0.0;
  double last_shown_ = -1.0;
  double interval_ = 0.0;
  std::string stage_;
};

/// Writes to standard error; one that takes nothing changes nothing else.
void tell(const std::string& text);

/// The exit code of a job that was stopped on request.
inline constexpr int k_stopped = 4;

/// Set by SIGINT, SIGTERM and SIGHUP.
std::atomic<bool>& stop_flag();

/// From now on those signals ask for a stop; where none comes within 0.9 s, or at a second signal, the program ends at
/// once, and what it has finished stays for --resume.
void catch_signals();

}  // namespace mottle::app
