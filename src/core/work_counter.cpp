#include "mottle/core/work_counter.hpp"

#include <algorithm>
#include <utility>

namespace mottle {

WorkCounter::WorkCounter(const RunContext& context, std::string work, std::int64_t total)
    : context_(context),
      work_(std::move(work)),
      total_(total),
      stride_(std::max<std::int64_t>(total / 1000, 1)),
      last_report_(Clock::now()) {}

void WorkCounter::add(std::int64_t units) {
  if (context_.observer == nullptr) return;
  const std::int64_t before = done_.fetch_add(units);
  const std::int64_t done = std::min(before + units, total_);
  if (before / stride_ == (before + units) / stride_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || done <= reported_) return;  // another thread reports as much or more
  const Clock::time_point now = Clock::now();
  if (now - last_report_ < std::chrono::milliseconds(100)) return;
  last_report_ = now;
  reported_ = done;
  context_.progress(work_, done, total_);
}

}  // namespace mottle
