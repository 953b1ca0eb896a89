// What the caller hands to a computation: seed, number of threads, observer of progress, and stop request.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "mottle/core/error.hpp"

namespace mottle {

/// Receives progress and remarks; the library itself never prints. All calls come from one thread.
class ProgressObserver {
 public:
  virtual ~ProgressObserver() = default;
  /// `done` of `total` units of `stage` are finished.
  virtual void progress(const std::string& stage, std::int64_t done, std::int64_t total) = 0;
  /// Something the user should know but that stops nothing.
  virtual void warning(const std::string& text) = 0;
  /// One line on what has just been done.
  virtual void note(const std::string& text) = 0;
  /// One line of a result that is known before the computation ends.
  virtual void finding(const std::string& text) { note(text); }
};

/// Seed, threads, observer and stop request of one run.
struct RunContext {
  std::uint64_t seed = 1;
  int threads = 1;
  ProgressObserver* observer = nullptr;
  const std::atomic<bool>* stop = nullptr;

  bool stop_requested() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
  void throw_if_stopped() const {
    if (stop_requested()) throw Stopped("stopped on request");
  }
  void progress(const std::string& stage, std::int64_t done, std::int64_t total) const {
    if (observer != nullptr) observer->progress(stage, done, total);
  }
  void warning(const std::string& text) const {
    if (observer != nullptr) observer->warning(text);
  }
  void note(const std::string& text) const {
    if (observer != nullptr) observer->note(text);
  }
  void finding(const std::string& text) const {
    if (observer != nullptr) observer->finding(text);
  }
};

}  // namespace mottle
