// Which runs go into which tasks, and what a task's death costs.
#include "mottle/drivers/scheduler/run_queue.hpp"

#include <gmock/gmock.h>

namespace {

using mottle::Digest;
using mottle::drivers::RunQueue;
using mottle::drivers::runs_of_task;
using mottle::drivers::SchedulerOptions;
using mottle::drivers::TaskDeath;

constexpr Digest key(std::uint64_t number) {
  return {number, number};
}

RunQueue queue_of(std::uint64_t runs, const SchedulerOptions& options) {
  RunQueue queue(options);
  for (std::uint64_t run = 0; run < runs; ++run) queue.add(key(run), static_cast<Eigen::Index>(run));
  return queue;
}

TEST(RunsOfTask, ATaskTakesTenMinutesWhereThereAreEnoughRuns) {
  EXPECT_EQ(runs_of_task(100000, 6.0, {}), 100);
  EXPECT_EQ(runs_of_task(100000, 3600.0, {}), 1);
}

TEST(RunsOfTask, FewRunsAreSpreadOverAllThatCanBeAtWork) {
  EXPECT_EQ(runs_of_task(40, 1.0, {.runs_at_once = 8}), 5);
  EXPECT_EQ(runs_of_task(41, 1.0, {.runs_at_once = 8}), 6);
  EXPECT_EQ(runs_of_task(40, 1.0, {}), 1);
}

TEST(RunsOfTask, ATaskEndsWellBeforeItsTime) {
  EXPECT_EQ(runs_of_task(100000, 60.0, {.time = std::chrono::minutes(5)}), 3);  // 70 % of 5 min
  EXPECT_EQ(runs_of_task(100000, 600.0, {.time = std::chrono::minutes(5)}), 1);
}

TEST(RunsOfTask, TheStudysWordCounts) {
  EXPECT_EQ(runs_of_task(10, 1.0, {.runs_per_task = 7}), 7);
}

TEST(RunQueue, AnArrayHasNoMoreTasksThanAllowed) {
  RunQueue queue = queue_of(10, {.runs_per_task = 2});
  EXPECT_THAT(queue.next(3, 1.0).ends, testing::ElementsAre(2, 4, 6));
  EXPECT_EQ(queue.to_submit(), 4U);
  EXPECT_THAT(queue.next(3, 1.0).keys, testing::ElementsAre(key(6), key(7), key(8), key(9)));
}

TEST(RunQueue, RunsOfAnArrayThatWasNotSubmittedComeFirstAndInTheirOrder) {
  RunQueue queue = queue_of(4, {.runs_per_task = 1});
  const RunQueue::Next first = queue.next(2, 1.0);
  queue.take_back(first.keys);
  queue.take_back({key(77)});
  EXPECT_EQ(queue.to_submit(), 4U);
  EXPECT_THAT(queue.next(4, 1.0).keys, testing::ElementsAre(key(0), key(1), key(2), key(3)));
}

TEST(RunQueue, SamplesWithTheSameRunAreServedByOne) {
  RunQueue queue = queue_of(1, {});
  queue.add(key(0), 5);
  EXPECT_EQ(queue.next(10, 1.0).keys.size(), 1U);
  EXPECT_THAT(queue.take(key(0)), testing::ElementsAre(0, 5));
  EXPECT_TRUE(queue.empty());
}

TEST(RunQueue, WhatATaskDoesAlreadyIsNotSubmitted) {
  RunQueue queue = queue_of(3, {});
  queue.is_awaited(key(1));
  EXPECT_THAT(queue.next(10, 1.0).keys, testing::ElementsAre(key(0), key(2)));
  EXPECT_TRUE(queue.wants(key(1)));
}

TEST(RunQueue, OnlyTheRunInProgressIsChargedAndThenStandsAlone) {
  RunQueue queue = queue_of(4, {.runs_per_task = 4, .tries = 2});
  (void)queue.next(10, 1.0);
  EXPECT_FALSE(queue.put_back({.task = 1, .missing = {key(1), key(2), key(3)}, .has_begun = true}));
  const RunQueue::Next next = queue.next(10, 1.0);
  EXPECT_THAT(next.keys, testing::ElementsAre(key(1), key(2), key(3)));
  EXPECT_THAT(next.ends, testing::ElementsAre(1, 3));
  const auto failure = queue.put_back({.task = 1, .missing = {key(1)}, .has_begun = true, .reason = "TIMEOUT on n1"});
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->key, key(1));
  EXPECT_TRUE(failure->is_begun);
  EXPECT_THAT(failure->text, testing::HasSubstr("2 times before it did, last: TIMEOUT on n1"));
  EXPECT_FALSE(queue.put_back({.task = 2, .missing = {key(2), key(3)}, .has_begun = true}));
}

TEST(RunQueue, ARunThatAnEarlierMottleHasChargedStandsAloneFromTheStart) {
  RunQueue queue = queue_of(2, {.runs_per_task = 9, .tries = 3});
  queue.add(key(5), 7, 2);
  EXPECT_THAT(queue.next(10, 1.0).ends, testing::ElementsAre(1, 3));
  EXPECT_EQ(queue.deaths_of(key(5)), 2);
  EXPECT_TRUE(queue.put_back({.task = 1, .missing = {key(5)}, .has_begun = true}));
}

TEST(RunQueue, AFullDiskBlamesNoRun) {
  RunQueue queue = queue_of(1, {.tries = 2});
  const TaskDeath death{.task = 1, .missing = {key(0)}, .has_begun = true, .is_disk_full = true};
  EXPECT_FALSE(queue.put_back(death));
  EXPECT_EQ(queue.deaths_of(key(0)), 0);
  const auto failure = queue.put_back(death);
  ASSERT_TRUE(failure);
  EXPECT_FALSE(failure->is_begun);
}

TEST(RunQueue, TasksThatNeverBeginBlameNoRun) {
  RunQueue queue = queue_of(2, {.runs_per_task = 2, .tries = 2});
  const TaskDeath death{.task = 1, .missing = {key(0), key(1)}, .has_begun = false};
  (void)queue.next(10, 1.0);
  EXPECT_FALSE(queue.put_back(death));
  EXPECT_THAT(queue.next(10, 1.0).ends, testing::ElementsAre(2));
  const auto failure = queue.put_back(death);
  ASSERT_TRUE(failure);
  EXPECT_FALSE(failure->is_begun);
}

TEST(RunQueue, RunsThatNobodyWantsAnyMoreAreNotSubmittedAgain) {
  RunQueue queue = queue_of(2, {});
  (void)queue.next(10, 1.0);
  (void)queue.take(key(0));
  EXPECT_FALSE(queue.put_back({.task = 1, .missing = {key(0), key(1), key(77)}, .has_begun = true}));
  EXPECT_THAT(queue.next(10, 1.0).keys, testing::ElementsAre(key(1)));
}

}  // namespace
