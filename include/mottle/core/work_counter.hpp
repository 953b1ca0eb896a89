// Counts work that several threads finish, and reports it seldom enough to cost nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "mottle/core/run_context.hpp"

namespace mottle {

/// Units of one kind of work, counted where they are finished. The observer hears of them at most ten times a second,
/// and not at all of work that is over within a tenth.
class WorkCounter {
 public:
  /// @param context  must outlive this object
  /// @param total    number of units, >= 0
  WorkCounter(const RunContext& context, std::string work, std::int64_t total);

  /// So many more units are finished. May be called by several threads at once.
  void add(std::int64_t units = 1);

 private:
  using Clock = std::chrono::steady_clock;

  const RunContext& context_;
  std::string work_;
  std::int64_t total_;
  std::int64_t stride_;  // units from one look at the clock to the next
  std::atomic<std::int64_t> done_{0};
  std::mutex mutex_;  // of the next two
  Clock::time_point last_report_;
  std::int64_t reported_ = 0;
};

}  // namespace mottle
