// Files that all runs are given: what one run does to them reaches no other.
#include "mottle/drivers/command/input_files.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class InputFilesTest : public testing::Test {
 protected:
  InputFilesTest() {
    for (const char* name : {"shared", "a", "b"}) fs::create_directory(folder_ / name);
    write_run_file(folder_ / "mesh.inc", "1 2 3\n");
  }
  std::vector<RunFile> files() const { return {{.source = folder_ / "mesh.inc", .name = "sub/mesh.inc"}}; }
  std::string read(const std::string& run) const { return read_file(folder_ / run / "sub/mesh.inc"); }
  void change(const fs::path& file) const {
    fs::permissions(file, fs::perms::owner_all);
    std::ofstream(file) << "9\n";
  }

  test::TemporaryFolder folder_;
};

TEST_F(InputFilesTest, EachRunHasACopyOfItsOwn) {
  InputFiles inputs(files(), folder_ / "shared");
  change(folder_ / "mesh.inc");  // the user's, after the start
  inputs.put_into(folder_ / "a");
  change(folder_ / "a/sub/mesh.inc");
  inputs.put_into(folder_ / "b");
  EXPECT_EQ(read("a"), "9\n");
  EXPECT_EQ(read("b"), "1 2 3\n");
  EXPECT_NO_THROW(inputs.require_unchanged());
}

TEST_F(InputFilesTest, ACopyHasItsSourcesRights) {
  fs::permissions(folder_ / "mesh.inc", fs::perms::owner_read | fs::perms::owner_exec);
  InputFiles(files(), folder_ / "shared").put_into(folder_ / "a");
  EXPECT_EQ(fs::status(folder_ / "a/sub/mesh.inc").permissions(), fs::perms::owner_read | fs::perms::owner_exec);
}

TEST_F(InputFilesTest, WhatRunsAreMadeFromIsHeldAgainstWhatWasRead) {
  const InputFiles inputs(files(), folder_ / "shared");
  change(folder_ / "shared/sub/mesh.inc");
  EXPECT_THAT([&] { inputs.put_into(folder_ / "a"); },
              ThrowsMessage<SystemFailure>(HasSubstr("a run has changed the copy of 'sub/mesh.inc'")));
}

/// Where the file system cannot clone, large files are links; then a change is seen after the run that made it.
TEST_F(InputFilesTest, AChangeOfALargeFileIsSeen) {
  InputFiles inputs(files(), folder_ / "shared", 3);
  inputs.put_into(folder_ / "a");
  fs::permissions(folder_ / "shared/sub/mesh.inc", fs::perms::owner_all);  // rights alone change nothing
  EXPECT_NO_THROW(inputs.require_unchanged());
  change(folder_ / "a/sub/mesh.inc");
  if (!fs::is_symlink(folder_ / "a/sub/mesh.inc")) {
    inputs.put_into(folder_ / "b");
    EXPECT_EQ(read("b"), "1 2 3\n");
    return;
  }
  EXPECT_THAT([&] { inputs.require_unchanged(); },
              ThrowsMessage<SystemFailure>(HasSubstr("a run has changed the copy of 'sub/mesh.inc'")));
}

/// Runs beside it may have read what was there in between.
TEST_F(InputFilesTest, AChangeOfALargeFileThatIsPutBackIsSeen) {
  InputFiles inputs(files(), folder_ / "shared", 3);
  inputs.put_into(folder_ / "a");
  if (!fs::is_symlink(folder_ / "a/sub/mesh.inc")) GTEST_SKIP() << "this file system clones";
  change(folder_ / "a/sub/mesh.inc");
  std::ofstream(folder_ / "a/sub/mesh.inc") << "1 2 3\n";
  EXPECT_THROW(inputs.require_unchanged(), SystemFailure);
}

TEST_F(InputFilesTest, AKeptFolderLeadsToTheUsersFileAndLosesNothingOfIts) {
  InputFiles inputs(files(), folder_ / "shared", 3);
  inputs.put_into(folder_ / "a");
  const bool is_link = fs::is_symlink(folder_ / "a/sub/mesh.inc");
  inputs.relink(folder_ / "a");
  const fs::path place = folder_ / "a/sub/mesh.inc";
  EXPECT_EQ(is_link ? fs::read_symlink(place) : place, is_link ? folder_ / "mesh.inc" : place);
  // A run put a link to a folder of the user's in place of its own.
  fs::create_directory(folder_ / "user");
  write_run_file(folder_ / "user/mesh.inc", "mine\n");
  fs::create_directory_symlink(folder_ / "user", folder_ / "b/sub");
  inputs.relink(folder_ / "b");
  EXPECT_EQ(read_file(folder_ / "user/mesh.inc"), "mine\n");
}

}  // namespace
}  // namespace mottle::drivers
