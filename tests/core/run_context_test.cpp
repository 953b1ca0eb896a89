#include "mottle/core/run_context.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace mottle {
namespace {

class Recorder final : public ProgressObserver {
 public:
  void phase(const Phase& next) override { lines.push_back("phase " + next.text()); }
  void progress(const std::string& stage, std::int64_t done, std::int64_t total) override {
    lines.push_back(fmt::format("progress {} {}/{}", stage, done, total));
  }
  void warning(const std::string& text) override { lines.push_back("warning " + text); }
  void note(const std::string& text) override { lines.push_back("note " + text); }

  std::vector<std::string> lines;
};

TEST(RunContext, PassesEveryCallToItsObserver) {
  Recorder recorder;
  const RunContext context{.observer = &recorder};
  context.phase({.name = "update"});
  context.progress("cloud", 3, 10);
  context.warning("few tests");
  context.note("done");
  EXPECT_THAT(recorder.lines,
              ::testing::ElementsAre("phase update", "progress cloud 3/10", "warning few tests", "note done"));
}

TEST(RunContext, IsSilentWithoutAnObserver) {
  const RunContext context;
  EXPECT_NO_THROW({
    context.progress("cloud", 3, 10);
    context.warning("few tests");
    context.note("done");
  });
}

TEST(Phase, SaysWhetherItsStepsAreAllThereWillBe) {
  EXPECT_EQ((Phase{.name = "bootstrap sample", .step = 7, .steps = 200}.text()), "bootstrap sample 7 of 200");
  EXPECT_EQ((Phase{.name = "iteration", .step = 2, .steps = 30, .may_end_early = true}.text()),
            "iteration 2 of at most 30");
}

TEST(RunContext, IsNeverStoppedWithoutAFlag) {
  EXPECT_NO_THROW(RunContext{}.throw_if_stopped());
}

TEST(RunContext, SeesTheStopFlagRiseWhileItRuns) {
  std::atomic<bool> stop{false};
  const RunContext context{.stop = &stop};
  EXPECT_FALSE(context.stop_requested());
  stop = true;
  EXPECT_TRUE(context.stop_requested());
}

TEST(RunContext, ThrowsStoppedOnRequest) {
  const std::atomic<bool> stop{true};
  EXPECT_THROW(RunContext{.stop = &stop}.throw_if_stopped(), Stopped);
}

}  // namespace
}  // namespace mottle
