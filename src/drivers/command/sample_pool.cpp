#include "mottle/drivers/command/sample_pool.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/drivers/command/solver_process.hpp"

namespace mottle::drivers {

SamplePool::SamplePool(Eigen::Index count, int parallel, Work work, std::function<Eigen::Index()> next)
    : count_(count), work_(std::move(work)), next_(std::move(next)) {
  if (!next_) next_ = [this] { return number_++; };
  const auto threads = std::min<Eigen::Index>(count, parallel);
  try {
    for (Eigen::Index t = 0; t < threads; ++t) threads_.emplace_back([this] { take_samples(); });
  } catch (const std::system_error& error) {  // fewer at once, then
    if (threads_.empty()) throw SystemFailure(fmt::format("no thread can be started: {}", error.code().message()));
  }
}

void SamplePool::wait(const RunContext& context) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (idle_ < threads_.size()) {
    changed_.wait_for(lock, std::chrono::milliseconds(100));
    if (context.stop_requested()) halt_ = true;
  }
  if (error_) std::rethrow_exception(error_);
  context.throw_if_stopped();
}

void SamplePool::take_samples() {
  const ProcessSeries series;
  for (Eigen::Index sample = next_(); sample < count_ && !halt_; sample = next_()) {
    try {
      work_(sample, halt_);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!error_ && !halt_) error_ = std::current_exception();
      halt_ = true;
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  ++idle_;
  changed_.notify_all();
}

void FailureCount::add(const std::string& failure) {
  const std::int64_t done = done_.add(1);
  if (failure.empty()) return;
  const std::int64_t failed = failed_.add(1);
  const std::lock_guard<std::mutex> lock(mutex_);
  last_.clear();  // what throws is over: the next batch has failures of its own
  limit_.require_few(done, failed, false, failure);
  last_ = failure;
}

void FailureCount::end_batch(Ranks* together) {
  std::string last = std::exchange(last_, {});
  if (together != nullptr) {
    for (const std::string& theirs : together->gather(last)) {
      if (!theirs.empty()) last = theirs;
    }
  }
  if (!last.empty()) limit_.require_few(done_.add(0), failed_.add(0), true, last);
}

void FailureLimit::require_few(std::int64_t done, std::int64_t failed, bool is_end, const std::string& last) const {
  constexpr std::int64_t k_fewest = 20;
  const auto runs = static_cast<double>(done);
  const double slack = is_end ? 0.0 : 3.0 * std::sqrt(max_fraction * (1.0 - max_fraction) * runs);
  if (done < k_fewest || static_cast<double>(failed) <= max_fraction * runs + slack) return;
  throw SystemFailure(fmt::format("{} of {} {} failed, at most {:.3g} % may (largest_failed_part){}; the last: {}",
                                  failed, done, what, 100.0 * max_fraction, where, last));
}

}  // namespace mottle::drivers
