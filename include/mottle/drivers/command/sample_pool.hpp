// Samples over threads, and how many of them may fail, for solvers whose every solution is the work of another program.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Distributes samples over threads, each of which works at one at a time; the thread that owns the pool reports
/// progress and forwards a stop request.
class SamplePool {
 public:
  using Work = std::function<void(Eigen::Index sample, const std::atomic<bool>& halt)>;

  /// Throws SystemFailure where no thread can be started.
  SamplePool(Eigen::Index count, int parallel, Work work);
  ~SamplePool() { halt_ = true; }
  SamplePool(const SamplePool&) = delete;
  SamplePool& operator=(const SamplePool&) = delete;

  /// Rethrows a sample's exception; throws Stopped.
  void wait(const RunContext& context);

 private:
  void take_samples();

  Eigen::Index count_;
  Work work_;
  std::atomic<Eigen::Index> next_{0};
  std::atomic<bool> halt_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::exception_ptr error_;
  std::size_t idle_ = 0;
  std::vector<std::jthread> threads_;  // last: they end before what they use
};

/// Counts runs and those that failed, of all batches together.
class FailureCount {
 public:
  /// @param where  what messages say of where failed runs are to be seen: "; folders of ..."; may be empty
  FailureCount(double max_fraction, std::string what, std::string where)
      : max_fraction_(max_fraction), what_(std::move(what)), where_(std::move(where)) {}

  /// One more run; `failure` is empty where it succeeded. Throws SystemFailure where significantly more than the
  /// allowed fraction failed (three standard errors).
  void add(const std::string& failure);
  /// Throws SystemFailure where more than the fraction failed: at the end of a batch that had failures.
  void end_batch();

 private:
  void require_few(bool is_end);

  double max_fraction_;
  std::string what_;
  std::string where_;
  std::mutex mutex_;
  std::int64_t done_ = 0;
  std::int64_t failed_ = 0;
  std::string last_ = {};  ///< of this batch
};

}  // namespace mottle::drivers
