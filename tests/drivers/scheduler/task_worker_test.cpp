// What a task does where it was given up, where another process does it, and where there is nothing for it.
#include "mottle/drivers/scheduler/task_worker.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <barrier>
#include <fstream>
#include <thread>

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

/// How many of several that begin the heartbeat of a task at the same moment may do it.
int winners(const std::filesystem::path& task) {
  constexpr int k_rivals = 6;
  std::barrier start(k_rivals);
  std::vector<std::unique_ptr<Heartbeat>> found(k_rivals);
  std::vector<std::jthread> threads;
  for (std::unique_ptr<Heartbeat>& heartbeat : found) {
    threads.emplace_back([&] {
      start.arrive_and_wait();
      heartbeat = Heartbeat::begin(task, std::chrono::milliseconds(400));
    });
  }
  threads.clear();
  return static_cast<int>(std::ranges::count_if(found, [](const auto& heartbeat) { return heartbeat != nullptr; }));
}

TEST_F(Worker, ATaskIsDoneByOneProcessAtATime) {
  EXPECT_EQ(winners(folder_.path()), 1);
  EXPECT_EQ(read_heartbeat(folder_.path()), "") << "it is at its end";
}

TEST_F(Worker, ATaskThatADeadProcessHasLeftIsDoneByOneProcess) {
  for (const char* left : {"of a task that was killed", ""}) {
    std::ofstream(folder_ / "alive") << left;
    EXPECT_EQ(winners(folder_.path()), 1) << left;
  }
}

TEST_F(Worker, AFolderWithoutAnArrayIsRefused) {
  EXPECT_THAT([&] { run_task(folder_.path(), 1, nullptr); },
              testing::ThrowsMessage<mottle::InvalidInput>(testing::HasSubstr("holds no array of tasks")));
}

}  // namespace
