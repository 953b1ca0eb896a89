// Signs of life of a task on another node: a small file that it rewrites every few seconds, and a file by which it is
// told to do nothing more.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "mottle/layers.hpp"

namespace mottle::drivers {

inline constexpr std::chrono::seconds k_heartbeat_interval{5};

/// Rewrites a task's file `alive` from a thread of its own as long as it lives, and takes it away at the end.
class Heartbeat {
 public:
  /// The heartbeat of a task that no other process does, on this node or another; null where one does. Where there is
  /// a file `alive`, it waits for two to four intervals to tell: locks tell it sooner, where nodes see each other's.
  ///
  /// @param task  the task's folder
  static std::unique_ptr<Heartbeat> begin(const std::filesystem::path& task,
                                          std::chrono::milliseconds interval = k_heartbeat_interval);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  Heartbeat(std::filesystem::path file, unsigned id, std::chrono::milliseconds interval);

  std::filesystem::path file_;
  std::jthread thread_;
};

/// What the last beat wrote: every one writes something else. Empty: there is none.
std::string read_heartbeat(const std::filesystem::path& task);

/// Tells a task that it was given up: it does not begin another run. A task that comes later does none.
void give_up(const std::filesystem::path& task);
/// Takes that back.
void take_up(const std::filesystem::path& task);
bool is_given_up(const std::filesystem::path& task);

}  // namespace mottle::drivers
