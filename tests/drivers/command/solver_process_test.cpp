// Running other programs: what they get, how they end, and that nothing of them outlives its time.
#include "mottle/drivers/command/solver_process.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "support/instrumented.hpp"

namespace {

using namespace std::chrono_literals;
using mottle::drivers::ProcessEnd;
using mottle::drivers::ProcessRequest;
using testing::HasSubstr;

class SolverProcess : public testing::Test {
 protected:
  ProcessEnd run(std::vector<std::string> arguments, std::chrono::milliseconds timeout = 20s,
                 const std::atomic<bool>* stop = nullptr) {
    return mottle::drivers::run_process({.arguments = std::move(arguments),
                                         .directory = folder_.path(),
                                         .environment = {{"MOTTLE_TEST_WORD", "two words"}},
                                         .timeout = timeout,
                                         .grace = 200ms,
                                         .stop = stop});
  }
  std::string read(const std::string& name) { return mottle::read_file(folder_.path() / name); }
  /// Waits for a process that wrote its number into `file` to be gone.
  bool is_gone(const std::string& file) {
    const pid_t process = std::stoi(read(file));
    for (int look = 0; look < 100; ++look) {
      if (::kill(process, 0) != 0) return true;
      std::this_thread::sleep_for(50ms);
    }
    return false;
  }

  mottle::test::TemporaryFolder folder_;
};

TEST_F(SolverProcess, ArgumentsReachTheProgramWithoutAShell) {
  EXPECT_EQ(run({"printf", "%s|", "a b", "$HOME; rm -rf *", "'\""}).kind, ProcessEnd::Kind::done);
  EXPECT_EQ(read("stdout.txt"), "a b|$HOME; rm -rf *|'\"|");
}

TEST_F(SolverProcess, RunsInItsFolderWithItsEnvironment) {
  EXPECT_EQ(run({"sh", "-c", "pwd; echo $MOTTLE_TEST_WORD; echo to-error >&2; cat"}).kind, ProcessEnd::Kind::done);
  EXPECT_EQ(read("stdout.txt"), std::filesystem::canonical(folder_.path()).string() + "\ntwo words\n");
  EXPECT_EQ(read("stderr.txt"), "to-error\n");
}

TEST_F(SolverProcess, EndsAreToldInWords) {
  EXPECT_EQ(run({"sh", "-c", "exit 7"}).reason, "exit status 7");
  EXPECT_THAT(run({"sh", "-c", "kill -SEGV $$"}).reason, HasSubstr("killed by signal 11 (Segmentation fault"));
  EXPECT_THAT(run({"/no/such/program"}).reason, HasSubstr("No such file"));
}

TEST_F(SolverProcess, AHangingProgramAndItsChildrenEndAtTheTimeout) {
  const auto start = std::chrono::steady_clock::now();
  const ProcessEnd end =
      run({"sh", "-c", "trap '' TERM; sleep 1000 & echo $! > child; echo $$ > self; wait; wait"}, 500ms);
  EXPECT_EQ(end.kind, ProcessEnd::Kind::timed_out);
  EXPECT_EQ(end.reason, "no end within 0.5 s, stopped");
  EXPECT_LT(std::chrono::steady_clock::now() - start, 10s);
  EXPECT_TRUE(is_gone("child"));
  EXPECT_TRUE(is_gone("self"));
}

TEST_F(SolverProcess, AGuardThatOthersEndSaysNothingOfTheProgram) {
  EXPECT_EQ(run({"sh", "-c", "kill -KILL $PPID; sleep 1000"}).kind, ProcessEnd::Kind::lost);
  const ProcessEnd end = run({"sh", "-c", "kill -TERM $PPID; sleep 1000"});
  EXPECT_EQ(end.kind, ProcessEnd::Kind::lost);
  EXPECT_THAT(end.reason, HasSubstr("guard was asked from outside"));
}

TEST_F(SolverProcess, AGuardThatTheProgramHasStoppedEndsItAtTheTimeout) {
  EXPECT_EQ(run({"sh", "-c", "kill -STOP $PPID; sleep 1000"}, 500ms).kind, ProcessEnd::Kind::timed_out);
}

// A scheduler that suspends a job stops all of its processes, here the two that matter.
TEST_F(SolverProcess, TheTimeThatAJobIsSuspendedForDoesNotCount) {
  const pid_t mottle = ::fork();
  if (mottle == 0) {
    const bool is_done =
        run({"sh", "-c", "echo $$ > self.new; mv self.new self; for i in 1 2 3 4 5 6; do sleep 0.25; done"}, 3s).kind ==
        ProcessEnd::Kind::done;
    ::_exit(is_done ? 0 : 1);
  }
  while (!std::filesystem::exists(folder_.path() / "self")) std::this_thread::sleep_for(10ms);
  ::kill(mottle, SIGSTOP);
  ::kill(std::stoi(read("self")), SIGSTOP);
  std::this_thread::sleep_for(4s);
  ::kill(std::stoi(read("self")), SIGCONT);
  ::kill(mottle, SIGCONT);
  int status = 1;
  ::waitpid(mottle, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(SolverProcess, WhatAProgramLeavesRunningIsKilled) {
  EXPECT_EQ(run({"sh", "-c", "sleep 1000 & echo $! > child"}).kind, ProcessEnd::Kind::done);
  EXPECT_TRUE(is_gone("child"));
}

TEST_F(SolverProcess, WhatLeavesItsSessionIsKilledToo) {
  EXPECT_EQ(run({"sh", "-c",
                 "setsid sh -c 'echo $$ > self; sleep 1000 & echo $! > child.new; mv child.new child; wait' & "
                 "while [ ! -e child ]; do sleep 0.02; done"})
                .kind,
            ProcessEnd::Kind::done);
  EXPECT_TRUE(is_gone("self"));
  EXPECT_TRUE(is_gone("child"));
}

TEST_F(SolverProcess, AFloodOfOutputEndsIt) {
  const ProcessEnd end = mottle::drivers::run_process({.arguments = {"sh", "-c", "exec yes >&2"},
                                                       .directory = folder_.path(),
                                                       .timeout = 60s,
                                                       .grace = 200ms,
                                                       .max_output = std::uintmax_t{1} << 20});
  EXPECT_EQ(end.kind, ProcessEnd::Kind::failed);
  EXPECT_EQ(end.reason, "it printed more than 1 MB to stderr.txt, stopped");
}

TEST_F(SolverProcess, AStopRequestIsAnsweredWithinASecondByAProgramThatIgnoresIt) {
  std::atomic<bool> stop{false};
  std::chrono::steady_clock::time_point asked;
  std::jthread later([&] {
    std::this_thread::sleep_for(300ms);
    asked = std::chrono::steady_clock::now();
    stop = true;
  });
  const ProcessEnd end =
      mottle::drivers::run_process({.arguments = {"sh", "-c", "trap '' TERM; while :; do sleep 0.05; done"},
                                    .directory = folder_.path(),
                                    .timeout = 100s,
                                    .grace = 60s,
                                    .stop = &stop});
  EXPECT_EQ(end.kind, ProcessEnd::Kind::stopped);
  EXPECT_LT(std::chrono::steady_clock::now() - asked, mottle::test::k_is_instrumented ? 5s : 1s);
}

TEST_F(SolverProcess, AStopRequestEndsIt) {
  std::atomic<bool> stop{false};
  std::jthread later([&] {
    std::this_thread::sleep_for(300ms);
    stop = true;
  });
  EXPECT_EQ(run({"sleep", "1000"}, 100s, &stop).kind, ProcessEnd::Kind::stopped);
}

// A batch system that ends a job signals all of its processes one by one: program, guard, Mottle, in any order.
TEST_F(SolverProcess, AnEndFromOutsideJustBeforeAStopRequestIsAStop) {
  for (const char* end : {"kill -TERM $$", "kill -KILL $$", "exit 143", "trap 'exit 1' TERM; kill -TERM $PPID; sleep 9",
                          "kill -KILL $PPID; sleep 9"}) {
    std::atomic<bool> stop{false};
    std::jthread later([&] {
      std::this_thread::sleep_for(300ms);
      stop = true;
    });
    EXPECT_EQ(run({"sh", "-c", end}, 100s, &stop).kind, ProcessEnd::Kind::stopped) << end;
  }
}

TEST_F(SolverProcess, AnEndFromOutsideWithoutAStopRequestIsAFailure) {
  const std::atomic<bool> stop{false};
  EXPECT_EQ(run({"sh", "-c", "kill -TERM $$"}, 100s, &stop).reason, "killed by signal 15 (Terminated)");
  EXPECT_EQ(run({"sh", "-c", "exit 143"}, 100s, &stop).reason, "exit status 143");
}

TEST_F(SolverProcess, ItDoesNotOutliveAMottleThatIsKilled) {
  const pid_t mottle = ::fork();
  if (mottle == 0) {
    run({"sh", "-c", "sleep 1000 & echo $! > child.new; echo $$ > self; mv child.new child; wait"}, 100s);
    ::_exit(0);
  }
  for (int look = 0; look < 200 && !std::filesystem::exists(folder_.path() / "child"); ++look) {
    std::this_thread::sleep_for(50ms);
  }
  ::kill(mottle, SIGKILL);
  ::waitpid(mottle, nullptr, 0);
  EXPECT_TRUE(is_gone("self"));
  EXPECT_TRUE(is_gone("child"));
}

/// The number of the process that guards a program which ends well.
class SolverProcesses : public SolverProcess {
 protected:
  std::string guard() {
    EXPECT_EQ(run({"sh", "-c", "echo $PPID > guard"}).kind, ProcessEnd::Kind::done);
    return read("guard");
  }
};

TEST_F(SolverProcesses, HaveOneGuardThatEndsWithTheSeries) {
  EXPECT_NE(guard(), guard());
  {
    const mottle::drivers::ProcessSeries series;
    const std::string first = guard();
    EXPECT_EQ(guard(), first);
    {
      const mottle::drivers::ProcessSeries within;
      EXPECT_NE(guard(), first);
    }
    EXPECT_EQ(guard(), first);
    std::jthread([&] { EXPECT_NE(guard(), first); }).join();  // which has none
  }
  EXPECT_TRUE(is_gone("guard"));
}

TEST_F(SolverProcesses, AreNotDisturbedByTheEndOfAnotherSeries) {
  const mottle::drivers::ProcessSeries series;
  for (int turn = 0; turn < 3; ++turn) {
    EXPECT_EQ(run({"sh", "-c", "exit 7"}).reason, "exit status 7");
    EXPECT_THAT(run({"/no/such/program"}).reason, HasSubstr("No such file"));
    EXPECT_EQ(run({"sleep", "1000"}, 50ms).kind, ProcessEnd::Kind::timed_out);
    EXPECT_EQ(run({"sh", "-c", "sleep 1000 & echo $! > child"}).kind, ProcessEnd::Kind::done);
    EXPECT_TRUE(is_gone("child"));
  }
  const std::string large(100'000, 'x');  // of an argument the system takes 128 KiB
  EXPECT_EQ(run({"printf", "%s", large, large, large, large, large, large}).kind, ProcessEnd::Kind::done);
  EXPECT_EQ(read("stdout.txt").size(), 600'000U);
}

TEST_F(SolverProcesses, SurviveThatTheirGuardIsKilledBetweenThem) {
  const mottle::drivers::ProcessSeries series;
  const std::string first = guard();
  ::kill(std::stoi(first), SIGKILL);
  siginfo_t ended;  // and stays, for the series to wait for it
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(std::stoi(first)), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_NE(guard(), first);
}

TEST_F(SolverProcesses, AreNotStartedByAGuardThatWasAskedToEnd) {
  const mottle::drivers::ProcessSeries series;
  ::kill(std::stoi(guard()), SIGTERM);
  EXPECT_EQ(run({"sh", "-c", "echo > started"}).kind, ProcessEnd::Kind::lost);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "started"));
  guard();
}

TEST_F(SolverProcesses, LeaveNoGuardWhereMottleIsKilledBetweenThem) {
  const pid_t mottle = ::fork();
  if (mottle == 0) {
    const mottle::drivers::ProcessSeries series;
    guard();
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(mottle, nullptr, 0);
  EXPECT_TRUE(is_gone("guard"));
}

TEST_F(SolverProcess, ManyAtOnceDoNotDisturbEachOther) {
  std::vector<std::jthread> threads;
  std::atomic<int> right{0};
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      const mottle::test::TemporaryFolder own;
      for (int i = 0; i < 10; ++i) {
        const ProcessEnd end = mottle::drivers::run_process(
            {.arguments = {"sh", "-c", "exit " + std::to_string(t + 1)}, .directory = own.path(), .timeout = 60s});
        if (end.reason == "exit status " + std::to_string(t + 1)) ++right;
      }
    });
  }
  threads.clear();
  EXPECT_EQ(right, 80);
}

/// While one thread writes a script, others start programs, which for a moment have the script open for writing.
TEST_F(SolverProcess, AScriptThatWasJustWrittenCanBeRun) {
  std::vector<std::jthread> threads;
  std::atomic<int> right{0};
  for (int t = 0; t < 6; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        const mottle::test::TemporaryFolder own;
        mottle::drivers::write_run_file(own / "solver.sh", "#!/bin/sh\n" + std::string(1 << 20, '#') + "\nexit 9\n");
        std::filesystem::permissions(own / "solver.sh", std::filesystem::perms::owner_all);
        if (mottle::drivers::run_process({.arguments = {"./solver.sh"}, .directory = own.path(), .timeout = 60s})
                .reason == "exit status 9") {
          ++right;
        }
      }
    });
  }
  threads.clear();
  EXPECT_EQ(right, 120);
}

}  // namespace
