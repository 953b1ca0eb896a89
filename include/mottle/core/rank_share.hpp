// Shares the work of one batch out over ranks and their threads.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>

#include "mottle/core/ranks.hpp"
#include "mottle/core/run_context.hpp"
#include "mottle/core/work_counter.hpp"

namespace mottle {

/// The loops of one batch. Which rank does which chunk is not known before and changes no number: chunks' borders
/// depend on the batch alone, and what they find is put together by number.
class RankShare {
 public:
  explicit RankShare(Ranks& ranks) : ranks_(ranks) {}

  Ranks& ranks() const { return ranks_; }

  /// Hears on rank 0 of the work that other ranks have taken.
  void count_with(WorkCounter* counter) { counter_ = counter; }

  /// As parallel_for(), with the chunks shared out; returns when none is left to take, with those of other ranks maybe
  /// still under way. A single chunk is done by every rank: that takes no longer than waiting for it.
  void loop(std::int64_t count, std::int64_t grain, int threads,
            const std::function<void(std::int64_t begin, std::int64_t end)>& body);

  /// The numbers of a loop, each given once to one rank, in no order.
  class Numbers {
   public:
    Numbers(RankShare& share, std::int64_t count, std::int64_t units);
    /// The next that nobody has, or `count` and more. Any thread.
    std::int64_t take();

   private:
    RankShare& share_;
    std::uint64_t counter_;
    std::int64_t count_;
    std::int64_t units_;  ///< of work for each number
    std::mutex mutex_;    // of the next two
    std::int64_t own_ = 0;
    std::int64_t others_ = 0;  ///< numbers that other ranks took, as far as this one knows
  };

  /// Whether something was shared: then a rank knows only its own part. The same on all ranks.
  bool is_shared() const { return is_shared_; }
  void set_shared() { is_shared_ = true; }

 private:
  Ranks& ranks_;
  WorkCounter* counter_ = nullptr;
  bool is_shared_ = false;
};

/// parallel_for() over the threads of this process, or of all ranks where the context shares the batch.
void shared_for(const RunContext& context, std::int64_t count, std::int64_t grain,
                const std::function<void(std::int64_t begin, std::int64_t end)>& body);

}  // namespace mottle
