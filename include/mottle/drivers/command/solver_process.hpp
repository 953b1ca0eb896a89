// Runs an external program once: without a shell, in a process group with files of its own, and with a time limit.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// What to run and where.
struct ProcessRequest {
  std::vector<std::string> arguments = {};                    ///< the program and what it is handed, as they are
  std::filesystem::path directory = {};                       ///< where it runs; its output goes to files there
  std::map<std::string, std::string> environment = {};        ///< added to Mottle's own
  std::chrono::milliseconds timeout = {};                     ///< then it is asked to end
  std::chrono::milliseconds grace = std::chrono::seconds(5);  ///< then it is ended
  std::uintmax_t max_output = std::uintmax_t{256} << 20;      ///< bytes it may print to either file; then it is ended
  const std::atomic<bool>* stop = nullptr;                    ///< ends it early
};

/// Where a program's output goes, in its directory.
inline constexpr const char* k_standard_output = "stdout.txt";
inline constexpr const char* k_standard_error = "stderr.txt";

/// How it ended.
struct ProcessEnd {
  /// `lost`: its guard was killed, or asked to end by somebody else than Mottle, which says nothing of the program.
  enum class Kind { done, failed, timed_out, stopped, lost };

  Kind kind = Kind::failed;
  std::string reason = {};  ///< of a failure: "exit status 2", "killed by signal 11 (Segmentation fault)"
  bool was_full = false;    ///< the file system of its directory had no room when it was looked at, ten times a second
};

/// Runs a program to its end, in a process group of its own. Whatever it leaves running when it ends, in that group or
/// out of it, is killed, and so is all of it at the timeout, at a stop request (within a second), and when Mottle
/// itself dies. So is a program counted that was ended from outside
/// within a second before a stop request.
///
/// @throws SystemFailure  no process can be started (memory, limits)
ProcessEnd run_process(const ProcessRequest& request);

class GuardProcess;

/// As long as it lives, programs that its thread runs one after the other share the process that guards them: to make
/// one, a copy of Mottle, takes longer than to start many a program.
class ProcessSeries {
 public:
  ProcessSeries();
  ~ProcessSeries();
  ProcessSeries(const ProcessSeries&) = delete;
  ProcessSeries& operator=(const ProcessSeries&) = delete;

 private:
  std::unique_ptr<GuardProcess> guard_;
  std::unique_ptr<GuardProcess>* before_ = nullptr;  ///< of the series around this one
};

/// The program's file: itself where `name` holds a slash, else the first of that name on PATH; empty: there is none.
std::filesystem::path find_program(const std::string& name);

}  // namespace mottle::drivers
