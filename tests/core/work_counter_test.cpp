#include "mottle/core/work_counter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "mottle/core/parallel.hpp"

namespace mottle {
namespace {

class Counts final : public ProgressObserver {
 public:
  void progress(const std::string& /*work*/, std::int64_t done, std::int64_t /*total*/) override {
    reported.push_back(done);
  }
  void warning(const std::string& /*text*/) override {}
  void note(const std::string& /*text*/) override {}

  std::vector<std::int64_t> reported;
};

TEST(WorkCounter, ReportsNothingOfWorkThatIsOverAtOnce) {
  Counts counts;
  const RunContext context{.observer = &counts};
  const auto begin = std::chrono::steady_clock::now();
  WorkCounter counter(context, "runs", 10'000);
  for (int i = 0; i < 10'000; ++i) counter.add();
  if (std::chrono::steady_clock::now() - begin > std::chrono::milliseconds(100)) GTEST_SKIP() << "the machine is busy";
  EXPECT_TRUE(counts.reported.empty());
}

TEST(WorkCounter, ReportsAscendingCountsOfAllThreads) {
  Counts counts;
  const RunContext context{.threads = 4, .observer = &counts};
  WorkCounter counter(context, "runs", 40);
  parallel_for(40, 1, context.threads, [&](std::int64_t, std::int64_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(40));
    counter.add();
  });
  ASSERT_GE(counts.reported.size(), 2U);  // ten rounds of 40 ms
  EXPECT_TRUE(std::is_sorted(counts.reported.begin(), counts.reported.end()));
  EXPECT_GT(counts.reported.back(), counts.reported.front());
  EXPECT_LE(counts.reported.back(), 40);
}

TEST(WorkCounter, NeedsNoObserver) {
  const RunContext context;
  WorkCounter counter(context, "runs", 1);
  EXPECT_NO_THROW(counter.add());
}

}  // namespace
}  // namespace mottle
