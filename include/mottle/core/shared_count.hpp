// A count that all ranks of a job add to.
#pragma once

#include <atomic>
#include <cstdint>

#include "mottle/core/ranks.hpp"

namespace mottle {

/// A count of this process, or of all ranks.
class SharedCount {
 public:
  /// All ranks make it, in the same order.
  explicit SharedCount(Ranks* ranks) : ranks_(ranks), counter_(ranks == nullptr ? 0 : ranks->new_counter()) {}

  /// The count with these. Any thread.
  std::int64_t add(std::int64_t more) {
    return more + (ranks_ == nullptr ? own_.fetch_add(more) : ranks_->add(counter_, more));
  }

 private:
  Ranks* ranks_;
  std::uint64_t counter_;
  std::atomic<std::int64_t> own_{0};
};

}  // namespace mottle
