#include "mottle/core/parallel.hpp"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

namespace mottle {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnceAtAnyThreadCount) {
  for (const int threads : {1, 2, 5}) {
    std::vector<int> visits(1003, 0);
    parallel_for(1003, 10, threads, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
    });
    EXPECT_EQ(std::set<int>(visits.begin(), visits.end()), std::set<int>{1}) << threads << " threads";
  }
}

TEST(ParallelFor, ChunkBordersDoNotDependOnTheThreadCount) {
  const auto borders = [](int threads) {
    std::set<std::pair<std::int64_t, std::int64_t>> seen;
    std::mutex mutex;
    parallel_for(100, 32, threads, [&](std::int64_t begin, std::int64_t end) {
      const std::lock_guard<std::mutex> lock(mutex);
      seen.insert({begin, end});
    });
    return seen;
  };
  EXPECT_EQ(borders(1), borders(3));
}

TEST(ParallelFor, RethrowsAnErrorOfTheBody) {
  for (const int threads : {1, 2}) {
    EXPECT_THROW(parallel_for(100, 1, threads,
                              [](std::int64_t begin, std::int64_t) {
                                if (begin == 50) throw std::runtime_error("chunk 50");
                              }),
                 std::runtime_error);
  }
}

TEST(ParallelFor, DoesNothingForAnEmptyRange) {
  parallel_for(0, 8, 2, [](std::int64_t, std::int64_t) { FAIL(); });
}

}  // namespace
}  // namespace mottle
