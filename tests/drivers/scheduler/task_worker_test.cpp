// What a task does where it was given up, where another process does it, and where there is nothing for it.
#include "mottle/drivers/scheduler/task_worker.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "core/temporary_folder.hpp"
#include "drivers/scheduler/heartbeat.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/scheduler/array_folder.hpp"

namespace {

using namespace mottle::drivers;

class Worker : public testing::Test {
 protected:
  Worker() {
    command_.templates = {{.source = folder_ / "in", .name = "in", .text = "{{k}}\n"}};
    command_.command = {.arguments = {"cat in > out; cat in >> " + (folder_ / "log").string()}, .is_shell = true};
    command_.frequencies = {.file = "out", .column = "1"};
    mottle::write_file_atomically(folder_ / "in", "");
    mottle::write_file_atomically(folder_ / "log", "");
  }
  std::ptrdiff_t solver_runs() {
    const std::string log = mottle::read_file(folder_ / "log");
    return std::count(log.begin(), log.end(), '\n');
  }

  mottle::test::TemporaryFolder folder_;
  SolverCommand command_;
};

TEST_F(Worker, ATaskThatWasGivenUpDoesNothing) {
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
  give_up(task_folder(folder_ / "array", 1));
  run_task(folder_ / "array", 1, nullptr);
  EXPECT_EQ(solver_runs(), 0);
  EXPECT_FALSE(read_task_end(folder_ / "array", 1).has_value());
  take_up(task_folder(folder_ / "array", 1));
  run_task(folder_ / "array", 1, nullptr);
  EXPECT_EQ(solver_runs(), 1);
  EXPECT_EQ(read_heartbeat(task_folder(folder_ / "array", 1)), "") << "it is at its end";
}

TEST_F(Worker, ATaskIsDoneByOneProcessAtATime) {
  const std::filesystem::path task = folder_ / "task";
  std::filesystem::create_directories(task);
  EXPECT_FALSE(is_beating(task, std::chrono::milliseconds(1)));
  {
    const Heartbeat heartbeat(task, std::chrono::milliseconds(20));
    EXPECT_TRUE(is_beating(task, std::chrono::milliseconds(100)));
  }
  mottle::write_file_atomically(task / "alive", "of a task that was killed");
  EXPECT_FALSE(is_beating(task, std::chrono::milliseconds(20)));
}

TEST_F(Worker, AFolderWithoutAnArrayIsRefused) {
  EXPECT_THAT([&] { run_task(folder_.path(), 1, nullptr); },
              testing::ThrowsMessage<mottle::InvalidInput>(testing::HasSubstr("holds no array of tasks")));
}

}  // namespace
