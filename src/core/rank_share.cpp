#include "mottle/core/rank_share.hpp"

#include <algorithm>
#include <atomic>

#include "mottle/core/parallel.hpp"

namespace mottle {

RankShare::Numbers::Numbers(RankShare& share, std::int64_t count, std::int64_t units)
    : share_(share), counter_(share.ranks().new_counter()), count_(count), units_(units) {
  share.set_shared();
}

std::int64_t RankShare::Numbers::take() {
  if (!share_.ranks().is_first()) return share_.ranks().add(counter_, 1);
  const std::lock_guard lock(mutex_);
  const std::int64_t number = share_.ranks().add(counter_, 1);
  if (number < count_) ++own_;
  const std::int64_t others = std::min(number + 1, count_) - own_;
  if (share_.counter_ != nullptr && others > others_) share_.counter_->add((others - others_) * units_);
  others_ = std::max(others, others_);
  return number;
}

void RankShare::loop(std::int64_t count, std::int64_t grain, int threads,
                     const std::function<void(std::int64_t, std::int64_t)>& body) {
  const std::int64_t chunks = (count + grain - 1) / grain;
  if (chunks <= 1) return parallel_for(count, grain, threads, body);
  Numbers numbers(*this, chunks, grain);
  std::atomic<bool> has_failed{false};
  parallel_for(threads, 1, threads, [&](std::int64_t, std::int64_t) {
    while (!has_failed) {
      const std::int64_t chunk = numbers.take();
      if (chunk >= chunks) return;
      try {
        body(chunk * grain, std::min(count, (chunk + 1) * grain));
      } catch (...) {
        has_failed = true;
        throw;
      }
    }
  });
}

void shared_for(const RunContext& context, std::int64_t count, std::int64_t grain,
                const std::function<void(std::int64_t, std::int64_t)>& body) {
  if (context.share != nullptr) return context.share->loop(count, grain, context.threads, body);
  parallel_for(count, grain, context.threads, body);
}

}  // namespace mottle
