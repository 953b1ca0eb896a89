#include "mottle/core/files.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>

#include "core/file_size_limit.hpp"
#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/folders.hpp"

namespace mottle {
namespace {

using test::FileSizeLimit;
using test::message_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  return names;
}

TEST(ReadFile, GivesBackTheBytesThatWereWritten) {
  const TemporaryFolder folder;
  const std::string bytes("a\r\nb\0\xff\n", 7);
  write_file_atomically(folder / "bytes", bytes);
  EXPECT_EQ(read_file(folder / "bytes"), bytes);
}

TEST(WriteFileAtomically, PutsPiecesOneAfterTheOther) {
  const TemporaryFolder folder;
  const std::vector<std::string_view> pieces{"one", "", "two"};
  write_file_atomically(folder / "pieces", pieces);
  EXPECT_EQ(read_file(folder / "pieces"), "onetwo");
}

/// The names given in a folder since this was made, in order.
class NamesGiven {
 public:
  explicit NamesGiven(const std::filesystem::path& folder) {
    ::inotify_add_watch(watch_, folder.c_str(), IN_CREATE | IN_MOVED_TO);
  }
  NamesGiven(const NamesGiven&) = delete;
  NamesGiven& operator=(const NamesGiven&) = delete;
  ~NamesGiven() { ::close(watch_); }

  std::vector<std::string> all() const {
    alignas(inotify_event) std::array<char, 4096> events{};
    const ssize_t size = ::read(watch_, events.data(), events.size());
    std::vector<std::string> names;
    for (ssize_t at = 0; at < size;) {
      const auto* event = reinterpret_cast<const inotify_event*>(events.data() + at);
      names.emplace_back(event->name);
      at += static_cast<ssize_t>(sizeof(inotify_event)) + event->len;
    }
    return names;
  }

 private:
  int watch_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
};

TEST(WriteFileAtomically, GivesANewFileNoOtherNameThatAKillCouldLeave) {
  const TemporaryFolder folder;
  const NamesGiven given(folder.path());
  write_file_atomically(folder / "new", "once");
  if (given.all() != std::vector<std::string>{"new"}) {
    const int unnamed = ::open(folder.path().c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0644);
    ASSERT_LT(unnamed, 0) << "another name was given";
    GTEST_SKIP() << "files without a name are not known here";
  }
  write_file_atomically(folder / "new", "again");
  EXPECT_THAT(names_in(folder.path()), ::testing::ElementsAre("new"));
  EXPECT_EQ(read_file(folder / "new"), "again");
}

TEST(ReadFile, GivesNothingFromAnEmptyFile) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "empty", "");
  EXPECT_EQ(read_file(folder / "empty"), "");
}

TEST(ReadFile, SaysThatAFileIsMissing) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "none.csv";
  EXPECT_EQ(message_of<InvalidInput>([&] { read_file(path); }), path.string() + ": no such file");
}

TEST(ReadFile, SaysThatAFolderIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(folder.path()); }), HasSubstr("is a folder"));
}

TEST(ReadFile, TellsAnUnreachablePathFromAMissingFile) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(folder / "loop"); }), HasSubstr("cannot be read: "));
}

TEST(ReadFile, ReportsAnInputErrorOfTheSystem) {
  // Linux: address 0 of a process is not mapped, so reading its memory from the start fails with EIO.
  if (!std::filesystem::exists("/proc/self/mem")) GTEST_SKIP() << "no /proc/self/mem on this system";
  EXPECT_THROW(read_file("/proc/self/mem"), SystemFailure);
}

TEST(ReadFile, DoesNotWaitForANamedPipe) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(folder / "pipe"); }),
              HasSubstr("is a named pipe, a regular file is needed"));
}

TEST(ReadFile, RefusesDevicesAndSockets) {
  EXPECT_THAT(message_of<InvalidInput>([] { read_file("/dev/zero"); }), HasSubstr("is a device"));
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/zero", folder / "link");
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(folder / "link"); }), HasSubstr("is a device"));
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address = {.sun_family = AF_UNIX, .sun_path = {}};
  const std::string place = (folder / "socket").string();
  ASSERT_LT(place.size(), sizeof(address.sun_path));
  place.copy(address.sun_path, place.size());
  ASSERT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(place); }), HasSubstr("is a socket"));
  ::close(descriptor);
}

TEST(ReadFile, RefusesAFileBeyondTheLimitBeforeItAsksForMemory) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "12345");
  EXPECT_EQ(read_file(folder / "file", 5), "12345");
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(folder / "file", 4); }), HasSubstr("has 5 bytes, at most 4"));
  std::filesystem::resize_file(folder / "file", std::uint64_t{1} << 42);  // 4 TiB that take no space
  EXPECT_THAT(message_of<InvalidInput>([&] { read_file(folder / "file"); }), HasSubstr("at most 8589934592"));
}

TEST(ReadFile, ReadsWhatTheSystemSaysIsEmpty) {
  // Files of /proc have a size of 0, as one that grows while it is read has too small a one.
  if (!std::filesystem::exists("/proc/self/status")) GTEST_SKIP() << "no /proc/self/status on this system";
  EXPECT_THAT(read_file("/proc/self/status"), HasSubstr("Name:"));
  EXPECT_THAT(message_of<InvalidInput>([] { read_file("/proc/self/status", 10); }), HasSubstr("at most 10"));
}

TEST(WriteFileAtomically, ReplacesWhatWasThere) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "a long first text");
  write_file_atomically(folder / "file", "short");
  EXPECT_EQ(read_file(folder / "file"), "short");
}

TEST(WriteFileAtomically, LeavesNoOtherFile) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "text");
  EXPECT_THAT(names_in(folder.path()), ::testing::ElementsAre("file"));
}

TEST(WriteFileAtomically, RefusesAPlaceThatIsNotThere) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "none" / "file";
  EXPECT_THAT(message_of<InvalidInput>([&] { write_file_atomically(path, "text"); }),
              StartsWith(path.string() + ": cannot be written: "));
}

TEST(WriteFileAtomically, ReportsADiskWithoutSpace) {
  const TemporaryFolder folder;
  const FileSizeLimit limit(4096);
  EXPECT_THROW(write_file_atomically(folder / "file", std::string(8192, 'x')), SystemFailure);
}

TEST(WriteFileAtomically, KeepsTheOldFileWhereTheNewOneDoesNotFit) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "old");
  {
    const FileSizeLimit limit(4096);
    EXPECT_THROW(write_file_atomically(folder / "file", std::string(8192, 'x')), SystemFailure);
  }
  EXPECT_EQ(read_file(folder / "file"), "old");
  EXPECT_THAT(names_in(folder.path()), ::testing::ElementsAre("file"));
}

TEST(WriteFileAtomically, DoesNotReplaceAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "name");
  EXPECT_THROW(write_file_atomically(folder / "name", "text"), Error);
  EXPECT_THAT(names_in(folder.path()), ::testing::ElementsAre("name"));
}

TEST(MakeWritableFolder, MakesTheFolderAndItsParents) {
  const TemporaryFolder folder;
  make_writable_folder(folder / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a" / "b"));
}

TEST(MakeWritableFolder, LeavesAnExistingFolderAsItWas) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "text");
  make_writable_folder(folder.path());
  EXPECT_THAT(names_in(folder.path()), ::testing::ElementsAre("file"));
}

TEST(MakeWritableFolder, TriesAFileWithoutAName) {
  const TemporaryFolder folder;  // a name would stay where Mottle is killed at that moment
  const auto before = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(folder.path(), before);
  make_writable_folder(folder.path());
  EXPECT_EQ(std::filesystem::last_write_time(folder.path()), before);
}

TEST(MakeWritableFolder, TakesAwayWhatItMadeInAPlaceThatTakesNoFile) {
  // The kernel's control groups are folders that anyone may make who is let, but files are the kernel's own.
  const std::filesystem::path groups =
      std::filesystem::exists("/sys/fs/cgroup/unified/cgroup.procs") ? "/sys/fs/cgroup/unified" : "/sys/fs/cgroup";
  const std::filesystem::path place = groups / "mottle-files-test";
  std::error_code error;
  const bool can_make =
      std::filesystem::exists(groups / "cgroup.procs") && std::filesystem::create_directory(place, error);
  std::filesystem::remove(place, error);
  if (!can_make) GTEST_SKIP() << "needs the right to make a control group";
  EXPECT_THROW(make_writable_folder(place / "out"), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(place));
  EXPECT_THROW(require_writable_folder(place / "out"), InvalidInput);
}

TEST(RequireWritableFolder, LeavesNothing) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::last_write_time(folder.path());
  require_writable_folder(folder.path());
  require_writable_folder(folder / "a" / "b");
  EXPECT_THAT(names_in(folder.path()), ::testing::IsEmpty());
  EXPECT_EQ(std::filesystem::last_write_time(folder.path()), before);
}

TEST(RequireWritableFolder, RefusesWithTheWordsOfMakeWritableFolder) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "text");
  std::filesystem::create_symlink("nowhere", folder / "link");
  for (const std::filesystem::path& place :
       {folder / "file", folder / "file" / "out", folder / "link", folder / std::string(300, 'x'),
        std::filesystem::path("/proc/mottle"), std::filesystem::path("/sys"), std::filesystem::path("/dev/full/out")}) {
    const std::string message = message_of<InvalidInput>([&] { make_writable_folder(place); });
    EXPECT_THAT(message, ::testing::StartsWith(place.string() + ": "));
    EXPECT_EQ(message_of<InvalidInput>([&] { require_writable_folder(place); }), message);
  }
}

TEST(MakeWritableFolder, RefusesTheNameOfAFile) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "text");
  EXPECT_THAT(message_of<InvalidInput>([&] { make_writable_folder(folder / "file"); }), HasSubstr("cannot be made"));
}

TEST(MakeWritableFolder, RefusesANameThatTheFileSystemDoesNotTake) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<InvalidInput>([&] { make_writable_folder(folder / std::string(5000, 'x')); }),
              HasSubstr("cannot be made"));
}

}  // namespace
}  // namespace mottle
