#include "progress_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mottle::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Phase iteration(int step) {
  return {.name = "iteration", .step = step, .steps = 30, .may_end_early = true};
}

TEST(ProgressLine, NamesThePhaseAtOnceAndGuessesNothing) {
  ProgressLine line;
  line.begin({.name = "cloud before the update"}, 100.0);
  EXPECT_EQ(line.text(100.0), "cloud before the update");
}

TEST(ProgressLine, SaysHowLongAPhaseLastsThatReportsNothing) {
  ProgressLine line;
  line.begin({.name = "reading the model and the tests"}, 100.0);
  EXPECT_EQ(line.text(114.0), "reading the model and the tests, 14 s so far");
}

TEST(ProgressLine, MeasuresTheRateFromTheFirstFinishedUnitOn) {
  ProgressLine line;
  line.begin({.name = "cloud"}, 0.0);
  line.count("model runs", 10, 1000, 60.0);  // a minute of preparation is not the pace
  EXPECT_THAT(line.text(60.0), Not(HasSubstr("left")));
  line.count("model runs", 30, 1000, 62.0);  // 10 a second: 970 more in 97 s
  EXPECT_EQ(line.text(62.0), "cloud: model runs 30 of 1000 (3 %), about 97 s left");
}

TEST(ProgressLine, FollowsAPaceThatChanges) {
  ProgressLine line;
  line.begin({.name = "cloud"}, 0.0);
  for (int second = 0; second <= 10; ++second) line.count("model runs", 50 * second, 1000, second);  // fast
  for (int second = 11; second <= 60; ++second) line.count("model runs", 500 + second - 10, 1000, second);
  EXPECT_THAT(line.text(60.0), HasSubstr("about 8 min left"));  // 450 at 1 a second
}

TEST(ProgressLine, SaysMoreTimeIsLeftTheLongerNothingComes) {
  ProgressLine line;
  line.begin({.name = "cloud"}, 0.0);
  line.count("model runs", 10, 100, 1.0);
  line.count("model runs", 20, 100, 2.0);
  EXPECT_THAT(line.text(2.0), HasSubstr("about 8 s left"));
  EXPECT_THAT(line.text(6.0), HasSubstr("about 40 s left"));
}

TEST(ProgressLine, NeverSaysThatNothingIsLeft) {
  ProgressLine line;
  line.begin({.name = "cloud"}, 0.0);
  line.count("model runs", 10, 100, 1.0);
  line.count("model runs", 100, 100, 3.0);
  EXPECT_EQ(line.text(3.0), "cloud: model runs 100 of 100 (100 %)");
}

TEST(ProgressLine, ShowsTheShareInsideAnIteration) {
  ProgressLine line;
  line.begin(iteration(2), 0.0);
  line.count("model runs", 400, 1000, 0.5);
  EXPECT_EQ(line.text(0.5), "iteration 2 of at most 30: model runs 400 of 1000 (40 %)");
}

TEST(ProgressLine, TakesTheTimeOfIterationsFromFinishedOnes) {
  ProgressLine line;
  line.begin({.name = "cloud before the update"}, 0.0);
  line.begin(iteration(1), 500.0);  // what was before is not counted
  line.begin(iteration(2), 504.0);
  line.begin(iteration(3), 508.0);
  EXPECT_EQ(line.text(509.0),
            "iteration 3 of at most 30, about 4 s each, at most 111 s left");  // 3 of this one, 27 more
}

TEST(ProgressLine, StatesTheTimeLeftOfAKnownNumberOfSteps) {
  ProgressLine line;
  for (int step = 1; step <= 3; ++step) {
    line.begin({.name = "bootstrap sample", .step = step, .steps = 200}, 2.0 * step);
  }
  EXPECT_EQ(line.text(6.0), "bootstrap sample 3 of 200, about 7 min left");  // 198 of 2 s
}

TEST(ProgressLine, ShowsNoShareWhereTheWholeIsNotKnown) {
  ProgressLine line;
  line.begin({.name = "cloud"}, 0.0);
  line.count("training the reduced model, vectors", 48, 0, 1.0);
  EXPECT_EQ(line.text(1.0), "cloud: training the reduced model, vectors 48");
  EXPECT_EQ(line.text(4.0), "cloud: training the reduced model, vectors 48, 4 s so far");
}

}  // namespace
}  // namespace mottle::app
