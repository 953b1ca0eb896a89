#include "mottle/core/rank_share.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "support/thread_ranks.hpp"

namespace mottle {
namespace {

using test::ThreadJob;

constexpr std::int64_t k_count = 1003;  // the last chunk is short

TEST(RankShare, EachIndexIsTheBusinessOfOneRank) {
  std::array<std::atomic<int>, k_count> visits{};
  ThreadJob(3).run([&](Ranks& ranks) {
    RankShare share(ranks);
    share.loop(k_count, 10, 2, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
    });
    EXPECT_TRUE(share.is_shared());
  });
  for (const std::atomic<int>& each : visits) EXPECT_EQ(each, 1);
}

TEST(RankShare, ChunksHaveTheBordersThatTheyHaveWithoutRanks) {
  std::mutex mutex;
  std::vector<std::int64_t> begins;
  ThreadJob(2).run([&](Ranks& ranks) {
    RankShare share(ranks);
    share.loop(25, 10, 1, [&](std::int64_t begin, std::int64_t end) {
      EXPECT_EQ(end, std::min<std::int64_t>(begin + 10, 25));
      const std::lock_guard lock(mutex);
      begins.push_back(begin);
    });
  });
  EXPECT_THAT(begins, testing::UnorderedElementsAre(0, 10, 20));
}

TEST(RankShare, ASingleChunkIsDoneByEveryRank) {
  std::atomic<int> calls{0};
  ThreadJob(3).run([&](Ranks& ranks) {
    RankShare share(ranks);
    share.loop(10, 10, 1, [&](std::int64_t, std::int64_t) { ++calls; });
    EXPECT_FALSE(share.is_shared());
  });
  EXPECT_EQ(calls, 3);
}

TEST(RankShare, LoopsDoNotTakeEachOthersNumbers) {
  std::atomic<int> calls{0};
  ThreadJob(2).run([&](Ranks& ranks) {
    RankShare share(ranks);
    for (int loop = 0; loop < 20; ++loop) share.loop(7, 1, 1, [&](std::int64_t, std::int64_t) { ++calls; });
  });
  EXPECT_EQ(calls, 140);
}

TEST(RankShare, AnErrorOfOneThreadEndsTheLoopOfAllItsThreads) {
  std::atomic<int> calls{0};
  const auto run = [&] {
    ThreadJob(1).run([&](Ranks& ranks) {
      RankShare(ranks).loop(1000, 1, 2, [&](std::int64_t begin, std::int64_t) {
        ++calls;
        if (begin == 3) throw SystemFailure("the disk is full");
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      });
    });
  };
  EXPECT_EQ(test::message_of<SystemFailure>(run), "the disk is full");
  EXPECT_LT(calls, 500);
}

class LastCount final : public ProgressObserver {
 public:
  void progress(const std::string& /*work*/, std::int64_t done, std::int64_t /*total*/) override { last = done; }
  void warning(const std::string& /*text*/) override {}
  void note(const std::string& /*text*/) override {}
  std::int64_t last = 0;
};

TEST(RankShare, TheFirstRankCountsTheWorkOfAll) {
  LastCount observed;
  ThreadJob(2).run([&](Ranks& ranks) {
    const RunContext context{.observer = ranks.is_first() ? &observed : nullptr};
    WorkCounter counter(context, "runs", 40);
    RankShare share(ranks);
    share.count_with(&counter);
    share.loop(40, 1, 1, [&](std::int64_t, std::int64_t) {
      // The first rank does a few and hears of the others.
      std::this_thread::sleep_for(std::chrono::milliseconds(ranks.is_first() ? 150 : 5));
      counter.add();
    });
  });
  EXPECT_GE(observed.last, 25);
  EXPECT_LE(observed.last, 40);
}

TEST(Ranks, OneMakesItForAllOfThemInAnyThread) {
  std::atomic<int> made{0};
  std::atomic<int> same{0};
  ThreadJob(3).run([&](Ranks& ranks) {
    const auto ask = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t key = begin; key < end; ++key) {
        const std::string found = ranks.once({static_cast<std::uint64_t>(key), 0}, ranks.rank() != 2, [&] {
          ++made;
          EXPECT_NE(ranks.rank(), 2);
          return std::to_string(key);
        });
        same += found == std::to_string(key) ? 1 : 0;
      }
    };
    parallel_for(20, 1, 4, ask);
    ask(0, 20);
  });
  EXPECT_EQ(made, 20);
  EXPECT_EQ(same, 3 * 2 * 20);
}

TEST(Ranks, AStopRequestEndsTheWaitForAnother) {
  std::atomic<bool> stop{false};
  const auto wait_for_nobody = [&] {
    ThreadJob(1).run([&](Ranks& ranks) {
      ranks.stop_by(&stop);
      std::jthread stopper([&] { stop = true; });
      (void)ranks.once({1, 2}, false, [] { return std::string(); });
    });
  };
  EXPECT_THROW(wait_for_nobody(), Stopped);
}

TEST(Ranks, OtherNumbersOnARankAreAnErrorThatNamesIt) {
  const std::string message = test::message_of<SystemFailure>([] {
    require_same_digests({{1, 2}, {1, 2}, {1, 3}}, "the samples of a batch");
  });
  EXPECT_THAT(message, testing::HasSubstr("rank 2"));
  EXPECT_THAT(message, testing::HasSubstr("the samples of a batch"));
}

TEST(Ranks, ShareTheProcessorsOfOneNode) {
  std::array<int, 2> threads{};
  ThreadJob(2).run([&](Ranks& ranks) {
    threads[static_cast<std::size_t>(ranks.rank())] = threads_of_rank(ranks);
    EXPECT_EQ(count_nodes(ranks), 1);
  });
  EXPECT_EQ(threads[0], std::max(1, available_threads() / 2));
  EXPECT_EQ(threads[1], threads[0]);
}

}  // namespace
}  // namespace mottle
