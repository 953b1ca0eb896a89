// What the caller hands to a computation: seed, number of threads, observer of progress, and stop request.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "mottle/core/error.hpp"

namespace mottle {

/// A named part of a job, which lasts until the next one begins.
struct Phase {
  std::string name;            ///< "cloud before the update", "iteration"
  std::int64_t step = 0;       ///< of several phases of this name the how-many-eth, from 1 on; 0: there is one
  std::int64_t steps = 0;      ///< their number
  bool may_end_early = false;  ///< `steps` are the most there can be

  /// "iteration 3 of at most 30"
  std::string text() const;
};

/// Receives progress and remarks; the library itself never prints. Calls come one at a time, but not all from the same
/// thread: work is counted where it is done.
class ProgressObserver {
 public:
  virtual ~ProgressObserver() = default;
  /// A phase begins, and the one before it is over.
  virtual void phase(const Phase& /*next*/) {}
  /// `done` of `total` units of `work` in the present phase are finished; `total` 0: their number is not known.
  virtual void progress(const std::string& work, std::int64_t done, std::int64_t total) = 0;
  /// What else is to be said of the work while it goes on; the last word counts, and an empty one takes it away.
  virtual void detail(const std::string& /*text*/) {}
  /// Something the user should know but that stops nothing.
  virtual void warning(const std::string& text) = 0;
  /// One line on what has just been done.
  virtual void note(const std::string& text) = 0;
  /// One line of a result that is known before the computation ends.
  virtual void finding(const std::string& text) { note(text); }
};

class Ranks;
class RankShare;

/// Seed, threads, observer and stop request of one run.
struct RunContext {
  std::uint64_t seed = 1;
  int threads = 1;
  ProgressObserver* observer = nullptr;
  const std::atomic<bool>* stop = nullptr;
  /// Shares the evaluation of one batch out over ranks; null: this process does it alone. Whoever is given it must do
  /// the same on every rank, in the same order.
  RankShare* share = nullptr;

  bool stop_requested() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
  void throw_if_stopped() const {
    if (stop_requested()) throw Stopped("stopped on request");
  }
  void phase(const Phase& next) const {
    if (observer != nullptr) observer->phase(next);
  }
  void progress(const std::string& work, std::int64_t done, std::int64_t total) const {
    if (observer != nullptr) observer->progress(work, done, total);
  }
  void detail(const std::string& text) const {
    if (observer != nullptr) observer->detail(text);
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
