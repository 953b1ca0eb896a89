// Samples over threads, and how many of them may fail, for solvers whose every solution is the work of another program.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/core/shared_count.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Distributes samples over threads, each of which works at one at a time; the thread that owns the pool reports
/// progress and forwards a stop request.
class SamplePool {
 public:
  using Work = std::function<void(Eigen::Index sample, const std::atomic<bool>& halt)>;

  /// @param next  a sample that nobody has, `count` or more where there is none; called by several threads at once.
  ///              Empty: one after the other
  /// Throws SystemFailure where no thread can be started.
  SamplePool(Eigen::Index count, int parallel, Work work, std::function<Eigen::Index()> next = {});
  ~SamplePool() { halt_ = true; }
  SamplePool(const SamplePool&) = delete;
  SamplePool& operator=(const SamplePool&) = delete;

  /// Rethrows a sample's exception; throws Stopped.
  void wait(const RunContext& context);

 private:
  void take_samples();

  Eigen::Index count_;
  Work work_;
  std::function<Eigen::Index()> next_;
  std::atomic<Eigen::Index> number_{0};
  std::atomic<bool> halt_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::exception_ptr error_;
  std::size_t idle_ = 0;
  std::vector<std::jthread> threads_;  // last: they end before what they use
};

/// How many runs may fail, and what messages say of them.
struct FailureLimit {
  double max_fraction = 0.0;
  std::string what;   ///< "solver runs"
  std::string where;  ///< where failed ones are to be seen: "; folders of ..."; may be empty

  /// Throws SystemFailure where significantly more than the allowed fraction failed (three standard errors), or, at the
  /// end of a batch, more than the fraction.
  void require_few(std::int64_t done, std::int64_t failed, bool is_end, const std::string& last) const;
};

/// Counts runs and those that failed, of all batches and of all ranks together.
class FailureCount {
 public:
  /// @param ranks  that share the runs; null: this process is alone. All of them make it, in the same order
  explicit FailureCount(FailureLimit limit, Ranks* ranks = nullptr)
      : limit_(std::move(limit)), done_(ranks), failed_(ranks) {}

  /// One more run; `failure` is empty where it succeeded. Throws SystemFailure where significantly more than the
  /// allowed fraction failed (three standard errors).
  void add(const std::string& failure);
  /// Throws SystemFailure where more than the fraction failed: at the end of a batch that had failures.
  ///
  /// @param together  ranks that shared the batch, all of which call it; null: none
  void end_batch(Ranks* together = nullptr);

 private:
  FailureLimit limit_;
  SharedCount done_;
  SharedCount failed_;
  std::mutex mutex_;       // of the next
  std::string last_ = {};  ///< of this batch
};

}  // namespace mottle::drivers
