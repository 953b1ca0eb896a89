// What killed Mottles leave in a folder of results goes, and nothing else does.
#include "mottle/drivers/command/run_folders.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

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

/// Who may not do everything, as long as it lives.
class NotRoot {
 public:
  NotRoot() {
    constexpr uid_t k_nobody = 65534;
    if (was_ == 0 && ::seteuid(k_nobody) != 0) throw std::runtime_error("cannot become nobody");
  }
  NotRoot(const NotRoot&) = delete;
  NotRoot& operator=(const NotRoot&) = delete;
  ~NotRoot() { (void)!::seteuid(was_); }

 private:
  uid_t was_ = ::geteuid();
};

// As where the solver of a killed Mottle, which its guard ends a moment later, still writes there.
TEST(RunFolders, WhereSomethingCannotBeRemovedTheMarkStaysForTheNextMottle) {
  const mottle::test::TemporaryFolder results;
  fs::permissions(results.path(), fs::perms::all);
  const pid_t dead = dead_process();
  const NotRoot user;
  {
    const RunFolders folders(results.path(), false);
    fs::copy_file(folders.shared().parent_path() / ".mottle-run", results.path() / "mark");
  }
  const fs::path left = make(results.path(), dead, "aaaaaa");
  for (int run = 1; run <= 16; ++run) fs::create_directory(left / fmt::format("run-{}", run));
  fs::rename(results.path() / "mark", left / ".mottle-run");
  fs::path last;  // which is to be removed behind the mark
  for (const fs::directory_entry& entry : fs::directory_iterator(left)) {
    if (entry.is_directory()) last = entry.path();
  }
  write_file_atomically(last / "file", "text");
  fs::permissions(last, fs::perms::none);
  { const RunFolders folders(results.path(), false); }
  EXPECT_TRUE(fs::exists(left / ".mottle-run"));
  fs::permissions(last, fs::perms::owner_all);
  { const RunFolders folders(results.path(), false); }
  EXPECT_FALSE(fs::exists(left));
}

}  // namespace
