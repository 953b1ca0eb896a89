// Runs by a scheduler that the test plays: it starts tasks in this process, late, half, or not at all.
#include "mottle/drivers/scheduler/scheduled_runs.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

#include "core/temporary_folder.hpp"
#include "drivers/scheduler/command_bytes.hpp"
#include "drivers/scheduler/heartbeat.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_store.hpp"
#include "mottle/drivers/scheduler/task_worker.hpp"

namespace {

using namespace mottle::drivers;
using State = TaskReport::State;

/// What becomes of the tasks of an array.
enum class Fate {
  done,
  dead,
  dead_in_first_run,
  dead_in_second_run,
  silent_but_done,
  forgotten_then_done,
  unlisted_at_work,  // long after it should have been given up
  unlisted_dead,
  unlisted_dead_by_number,  // the second look finds it ended
  refused
};

class PlayedScheduler final : public Scheduler {
 public:
  explicit PlayedScheduler(std::vector<Fate>& fates, std::vector<ArrayRequest>& requests,
                           std::vector<std::string>& ended)
      : fates_(fates), requests_(requests), ended_(ended) {}

  std::string submit(const ArrayRequest& request) override {
    requests_.push_back(request);
    const Fate fate = fates_.empty() ? Fate::done : fates_.front();
    if (!fates_.empty()) fates_.erase(fates_.begin());
    if (fate == Fate::refused) throw mottle::SystemFailure("no");
    for (int task = 1; task <= request.tasks; ++task) {
      TaskReport report{.array = request.name, .task = task, .state = State::ended, .node = "n1", .words = "NODE_FAIL"};
      report.is_success = fate == Fate::done || fate == Fate::silent_but_done;
      if (fate == Fate::dead_in_second_run) do_one(request.folder, task);
      if (fate == Fate::dead_in_first_run) RunStore(task_folder(request.folder, task) / "runs.store");
      if (report.is_success || fate == Fate::forgotten_then_done) report.is_success &= do_all(request.folder, task);
      if (fate == Fate::unlisted_at_work) threads_.emplace_back(work_late, request.folder, task);
      if (fate == Fate::unlisted_dead_by_number) found_by_number_.push_back(report);
      if (fate < Fate::unlisted_at_work) reports_.push_back(report);
    }
    if (fate == Fate::silent_but_done) throw SchedulerSilent("no answer");
    return "7";
  }
  std::vector<TaskReport> list(const std::vector<std::string>& names) override {
    std::vector<TaskReport> found;
    std::ranges::copy_if(reports_, std::back_inserter(found), [&](const TaskReport& report) {
      return std::ranges::find(names, report.array) != names.end();
    });
    return found;
  }
  std::vector<TaskReport> look_up(const std::string& name, const std::string& job) override {
    EXPECT_EQ(job, "7");
    std::vector<TaskReport> found;
    std::ranges::copy_if(found_by_number_, std::back_inserter(found),
                         [&](const TaskReport& report) { return report.array == name; });
    return found;
  }
  void cancel(const std::string& name) override { ended_.push_back(name); }
  std::string number_variable() const override { return "TASK"; }

 private:
  /// Whether the task came to its end.
  static bool do_all(const std::filesystem::path& folder, int task) {
    try {
      run_task(folder, task, nullptr);
      return true;
    } catch (const mottle::SystemFailure&) {
      return false;
    }
  }
  static void work_late(const std::filesystem::path& folder, int task) {
    {
      const auto heartbeat = Heartbeat::begin(task_folder(folder, task), std::chrono::milliseconds(10));
      std::this_thread::sleep_for(std::chrono::seconds(6));
    }
    do_all(folder, task);
  }
  /// The first run of a task, by an array that has it alone, and no word of the end.
  static void do_one(const std::filesystem::path& folder, int task) {
    const std::filesystem::path file = folder / "array";
    const std::string whole = mottle::read_file(file);
    ArrayPlan plan = *read_array(folder);
    ArrayPlan one = plan;
    for (std::size_t t = 0; t < one.ends.size(); ++t) one.ends[t] = plan.begin_of(static_cast<int>(t) + 1) + 1;
    const std::size_t first = plan.begin_of(task);
    one.keys = {plan.keys[first]};
    one.values = plan.values.row(static_cast<Eigen::Index>(first)).eval();
    one.ends = {1};
    const std::filesystem::path other = folder / "other";
    write_array(other, one, "TASK");
    run_task(other, 1, nullptr);
    std::filesystem::rename(other / "task-1" / "runs.store", task_folder(folder, task) / "runs.store");
    std::filesystem::remove_all(other);
  }

  std::vector<Fate>& fates_;
  std::vector<ArrayRequest>& requests_;
  std::vector<std::string>& ended_;
  std::vector<TaskReport> reports_;
  std::vector<TaskReport> found_by_number_;
  std::vector<std::jthread> threads_;
};

class Scheduled : public testing::Test {
 protected:
  Scheduled() {
    command_.templates = {{.source = folder_ / "in", .name = "in", .text = "{{k}}\n"}};
    command_.command = {.arguments = {"cat in > out; cat in >> " + (folder_ / "log").string()}, .is_shell = true};
    command_.frequencies = {.file = "out", .column = "1"};
    command_.scheduler = SchedulerOptions{.runs_per_task = 3, .tries = 2};
    command_.kept = KeptRuns::none;
    mottle::write_file_atomically(folder_ / "in", "");
    mottle::write_file_atomically(folder_ / "log", "");
  }

  /// First frequencies in Hz, by sample; nan: the run failed.
  std::vector<double> run(const std::vector<double>& k) {
    SolverRuns runs(command_, {"k"}, {.results = folder_ / "results", .is_resumed = true});
    ScheduledRuns scheduled(runs, {.results = folder_ / "results", .is_resumed = true},
                            std::make_unique<PlayedScheduler>(fates_, requests_, ended_),
                            {.first_question = 0.02,
                             .last_question = 0.02,
                             .after_death = 0.02,
                             .after_end = 0.1,
                             .after_silence = after_silence_,
                             .poll = 0.01});
    std::vector<double> found(k.size(), -1.0);
    const Eigen::MatrixXd samples = Eigen::Map<const Eigen::VectorXd>(k.data(), static_cast<Eigen::Index>(k.size()));
    scheduled.run_all(samples, 1, {.stop = &stop_}, [&](Eigen::Index s, const SolverRuns::Run& one) {
      failures_ += one.record.failure;
      found[static_cast<std::size_t>(s)] =
          one.record.failure.empty() ? std::sqrt(one.record.modes.eigenvalues(0)) / (2.0 * 3.14159265358979323846)
                                     : -2.0;
    });
    return found;
  }
  std::ptrdiff_t solver_runs() {
    const std::string log = mottle::read_file(folder_ / "log");
    return std::count(log.begin(), log.end(), '\n');
  }
  static auto are(std::vector<double> values) {
    std::vector<testing::Matcher<double>> near;
    for (const double value : values) near.push_back(testing::DoubleNear(value, 1e-12 * value));  // of a square root
    return testing::ElementsAreArray(near);
  }

  mottle::test::TemporaryFolder folder_;
  SolverCommand command_;
  std::vector<Fate> fates_;
  std::vector<ArrayRequest> requests_;
  std::vector<std::string> ended_;
  std::string failures_;
  double after_silence_ = 0.3;
  std::atomic<bool> stop_{false};
};

TEST_F(Scheduled, EachSampleGetsItsOwnRunAndNothingStays) {
  EXPECT_THAT(run({1, 2, 3, 4, 2}), are({1, 2, 3, 4, 2}));
  EXPECT_EQ(solver_runs(), 4);
  ASSERT_EQ(requests_.size(), 1U);
  EXPECT_EQ(requests_[0].tasks, 2);
  EXPECT_LE(requests_[0].name.size(), 15U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results" / "tasks"));
}

TEST_F(Scheduled, RunsThatAreThereAreNotSubmitted) {
  (void)run({1, 2, 3});
  EXPECT_THAT(run({3, 2, 1}), are({3, 2, 1}));
  EXPECT_EQ(requests_.size(), 1U);
}

TEST_F(Scheduled, WhatADeadTaskHasDoneIsNotDoneAgain) {
  fates_ = {Fate::dead_in_second_run};
  EXPECT_THAT(run({1, 2, 3, 4, 5, 6}), are({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(solver_runs(), 6);
  ASSERT_EQ(requests_.size(), 2U);
  EXPECT_EQ(requests_[1].tasks, 3) << "the two that were in progress alone, the others together";
}

TEST_F(Scheduled, TasksThatNeverBeginEndTheJob) {
  fates_ = {Fate::dead, Fate::dead};
  EXPECT_THAT(
      [&] {
        run({1, 2});
      },
      testing::ThrowsMessage<mottle::SystemFailure>(testing::HasSubstr("before they begin with a run, the last: "
                                                                       "NODE_FAIL on n1")));
}

TEST_F(Scheduled, AnArrayThatWasSubmittedWithoutAnAnswerIsNotSubmittedTwice) {
  fates_ = {Fate::silent_but_done};
  EXPECT_THAT(run({1, 2}), are({1, 2}));
  EXPECT_EQ(requests_.size(), 1U);
}

TEST_F(Scheduled, ALateResultOfATaskThatWasCalledDeadIsTaken) {
  fates_ = {Fate::forgotten_then_done};
  EXPECT_THAT(run({1, 2}), are({1, 2}));
  EXPECT_EQ(requests_.size(), 1U);
}

TEST_F(Scheduled, ATaskThatTheSchedulerDoesNotListIsNotDoubledWhileItGivesSignsOfLife) {
  fates_ = {Fate::unlisted_at_work};
  after_silence_ = 2.0;  // twice that, and the task begins its runs only after 6 s
  EXPECT_THAT(run({1, 2, 3, 4}), are({1, 2, 3, 4}));
  EXPECT_EQ(requests_.size(), 1U);
  EXPECT_EQ(solver_runs(), 4);
}

TEST_F(Scheduled, ATaskThatIsNeitherListedNorAliveIsDoneAgain) {
  fates_ = {Fate::unlisted_dead};
  EXPECT_THAT(run({1, 2}), are({1, 2}));
  EXPECT_EQ(requests_.size(), 2U);
}

TEST_F(Scheduled, ASecondLookThatFindsATaskEndedIsBelieved) {
  fates_ = {Fate::unlisted_dead_by_number};
  after_silence_ = 1e6;
  EXPECT_THAT(run({1, 2}), are({1, 2}));
  EXPECT_EQ(requests_.size(), 2U);
}

TEST_F(Scheduled, DeathsAreCountedThroughARestart) {
  fates_ = {Fate::dead_in_second_run, Fate::refused};
  EXPECT_THROW(run({1, 2, 3}), mottle::SystemFailure);
  fates_ = {Fate::dead_in_first_run};  // the second and the third run, each in a task of its own
  EXPECT_THAT(run({1, 2, 3}), testing::ElementsAre(testing::DoubleEq(1.0), -2.0, testing::DoubleNear(3.0, 1e-12)));
  EXPECT_THAT(failures_, testing::HasSubstr("ended 2 times"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results" / "tasks"));
}

TEST_F(Scheduled, ADiskThatWasFullForAMomentIsNoFailureOfTheModel) {
  command_.command.arguments = {
      "test -e " + (folder_ / "flag").string() + " || { touch " + (folder_ / "flag").string() +
      "; echo 'write: No space left on device' >&2; exit 1; }; " + command_.command.arguments.front()};
  EXPECT_THAT(run({1, 2}), are({1, 2}));
  EXPECT_EQ(failures_, "");
  EXPECT_EQ(requests_.size(), 2U);
}

TEST_F(Scheduled, ADiskThatIsFullAgainAndAgainEndsTheJobAndNoRun) {
  const std::string works = command_.command.arguments.front();
  command_.command.arguments = {"test -e " + (folder_ / "room").string() +
                                " || { echo 'Disk quota exceeded'; exit 1; }; " + works};
  EXPECT_THROW(run({1, 2}), NoRoom);
  EXPECT_EQ(requests_.size(), 2U) << "as many as tries";
  mottle::write_file_atomically(folder_ / "room", "");
  EXPECT_THAT(run({1, 2}), are({1, 2}));
}

TEST_F(Scheduled, ArraysThatAnotherMottleLeftAreMergedBeforeAnythingIsSubmitted) {
  SolverRuns runs(command_, {"k"}, {.results = folder_ / "results"});
  const Eigen::MatrixXd values = (Eigen::MatrixXd(2, 1) << 1.0, 2.0).finished();
  ArrayPlan plan{
      .name = "mottle-00000001", .command = runs.frozen_command(), .parameters = {"k"}, .constants = runs.constants()};
  for (int run = 0; run < 2; ++run) plan.keys.push_back(runs.key_at(values.row(run).transpose(), 1));
  plan.values = values;
  plan.ends = {2};
  const std::filesystem::path left = folder_ / "left";
  write_array(left, plan, "TASK");
  write_array_job(left, "5");
  run_task(left, 1, nullptr);
  std::filesystem::create_directories(folder_ / "other" / "tasks");
  std::filesystem::rename(left, folder_ / "other" / "tasks" / plan.name);
  SolverRuns later(command_, {"k"}, {.results = folder_ / "other"});
  ScheduledRuns scheduled(later, {.results = folder_ / "other"},
                          std::make_unique<PlayedScheduler>(fates_, requests_, ended_));
  EXPECT_TRUE(later.find(plan.keys[1]).has_value());
  EXPECT_TRUE(requests_.empty());
}

TEST_F(Scheduled, ATaskFindsThatTheFilesHaveChanged) {
  mottle::write_file_atomically(folder_ / "data", "1");
  command_.files = {{.source = folder_ / "data", .name = "data"}};
  SolverRuns runs(command_, {"k"}, {.results = folder_ / "results"});
  const Eigen::VectorXd k = Eigen::VectorXd::Ones(1);
  const ArrayPlan plan{.name = "mottle-00000001",
                       .command = runs.frozen_command(),
                       .parameters = {"k"},
                       .constants = runs.constants(),
                       .keys = {runs.key_at(k, 1)},
                       .values = k.transpose(),
                       .ends = {1}};
  write_array(folder_ / "array", plan, "TASK");
  mottle::write_file_atomically(folder_ / "data", "2");
  EXPECT_THAT([&] { run_task(folder_ / "array", 1, nullptr); },
              testing::ThrowsMessage<mottle::InvalidInput>(testing::HasSubstr("have changed")));
}

TEST_F(Scheduled, ADamagedArrayIsNotRead) {
  SolverRuns runs(command_, {"k"}, {.results = folder_ / "results"});
  write_array(folder_ / "array", {.name = "mottle-00000001", .command = runs.frozen_command()}, "TASK");
  std::string bytes = mottle::read_file(folder_ / "array" / "array");
  bytes[bytes.size() / 2] ^= 1;
  mottle::write_file_atomically(folder_ / "array" / "array", bytes);
  EXPECT_THROW(read_array(folder_ / "array"), mottle::SystemFailure);
}

TEST_F(Scheduled, ACommandKeepsAllItsFieldsAsBytes) {
  command_.retry_command = CommandLine{.arguments = {"again", "{{k}}"}};
  command_.shapes = ShapeRule{.file = "shapes", .components = {"a"}};
  command_.environment = {{"A", "1"}, {"B", ""}};
  command_.timeout = std::chrono::milliseconds(1234);
  command_.scheduler->extra = {"--x"};
  std::string bytes;
  append_command(bytes, command_);
  SolverCommand read;
  mottle::ByteReader reader(bytes);
  ASSERT_TRUE(mottle::drivers::read_command(reader, read));
  EXPECT_EQ(reader.left(), 0U);
  std::string again;
  append_command(again, read);
  EXPECT_EQ(again, bytes);
  EXPECT_EQ(read.retry_command->arguments, command_.retry_command->arguments);
  EXPECT_EQ(read.scheduler->extra, command_.scheduler->extra);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    mottle::ByteReader cut(std::string_view(bytes).substr(0, size));
    EXPECT_FALSE(mottle::drivers::read_command(cut, read)) << size;
  }
}

}  // namespace
