// What killed Mottles leave in a folder of results goes, and nothing else does.
#include "mottle/drivers/command/run_folders.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/ranks.hpp"

namespace {

using mottle::write_file_atomically;
using mottle::drivers::RunFolders;
namespace fs = std::filesystem;

/// The number of a process that is no more.
pid_t dead_process() {
  const pid_t process = ::fork();
  if (process == 0) ::_exit(0);
  ::waitpid(process, nullptr, 0);
  return process;
}

/// A folder in `results`/runs as a process makes it, empty.
fs::path make(const fs::path& results, pid_t process, const std::string& random) {
  fs::path folder = results / "runs" / fmt::format("mottle-{}-{}-{}", mottle::node_name(), process, random);
  fs::create_directories(folder);
  return folder;
}

TEST(RunFolders, WhatAKilledMottleHadNotMarkedYetGoesWhereItIsEmpty) {
  const mottle::test::TemporaryFolder results;
  const pid_t dead = dead_process();
  const fs::path empty = make(results.path(), dead, "aaaaaa");
  const fs::path torn = make(results.path(), dead, "bbbbbb");
  write_file_atomically(torn / ".mottle-run", "Made by");
  const fs::path of_the_user = make(results.path(), dead, "cccccc");
  write_file_atomically(of_the_user / "notes", "text");
  const fs::path of_the_living = make(results.path(), ::getpid(), "dddddd");
  const fs::path of_another_host = results / "runs" / "mottle-elsewhere-1-eeeeee";
  fs::create_directory(of_another_host);
  { const RunFolders folders(results.path(), false); }
  EXPECT_FALSE(fs::exists(empty));
  EXPECT_FALSE(fs::exists(torn));
  EXPECT_TRUE(fs::exists(of_the_user / "notes"));
  EXPECT_TRUE(fs::exists(of_the_living));
  EXPECT_TRUE(fs::exists(of_another_host));
}

// A guard ends a solver a moment after its Mottle was killed.
TEST(RunFolders, WhereASolverStillWritesTheMarkStaysForTheNextMottle) {
  const mottle::test::TemporaryFolder results;
  const fs::path left = make(results.path(), dead_process(), "aaaaaa");
  {
    const RunFolders folders(results.path(), false);
    fs::copy_file(folders.shared().parent_path() / ".mottle-run", results.path() / "mark");
  }
  fs::create_directories(left / "run-1");
  fs::rename(results.path() / "mark", left / ".mottle-run");
  {
    const std::jthread solver([&](const std::stop_token& stop) {
      std::error_code ignored;
      for (int file = 0; !stop.stop_requested(); ++file) {
        fs::create_directory(left / "run-1", ignored);
        std::ofstream(left / "run-1" / fmt::format("{}", file)) << "text";
      }
    });
    for (int start = 0; start < 20; ++start) {
      { const RunFolders folders(results.path(), false); }
      EXPECT_TRUE(!fs::exists(left) || fs::exists(left / ".mottle-run"));
    }
  }
  { const RunFolders folders(results.path(), false); }
  EXPECT_FALSE(fs::exists(left));
}

}  // namespace
