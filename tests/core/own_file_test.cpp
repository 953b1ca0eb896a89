#include "mottle/core/own_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle {
namespace {

using test::message_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

void write_through(const std::filesystem::path& path, ExistingFile existing, const std::string& text) {
  const int descriptor = open_own_file(path, existing);
  EXPECT_EQ(::write(descriptor, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  ::close(descriptor);
}

TEST(OpenOwnFile, MakesReplacesAndKeeps) {
  const TemporaryFolder folder;
  write_through(folder / "file", ExistingFile::keep, "longer");
  write_through(folder / "file", ExistingFile::keep, "L");
  EXPECT_EQ(read_file(folder / "file"), "Longer");
  write_through(folder / "file", ExistingFile::replace, "new");
  EXPECT_EQ(read_file(folder / "file"), "new");
}

TEST(OpenOwnFile, ReplacesLinksSecondNamesAndPipesAndNotWhatTheyLeadTo) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "mine", "mine");
  std::filesystem::create_symlink("mine", folder / "link");
  std::filesystem::create_hard_link(folder / "mine", folder / "second");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const char* name : {"link", "second", "pipe"}) {
    write_through(folder / name, ExistingFile::replace, "new");
    EXPECT_EQ(read_file(folder / name), "new") << name;
  }
  EXPECT_EQ(read_file(folder / "mine"), "mine");
}

TEST(OpenOwnFile, KeepsRegularFilesAlone) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "mine", "mine");
  std::filesystem::create_symlink("mine", folder / "link");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto message_for = [&](const std::string& name) {
    return message_of<InvalidInput>([&] { open_own_file(folder / name, ExistingFile::keep); });
  };
  EXPECT_THAT(message_for("link"), HasSubstr("link: is a link"));
  EXPECT_THAT(message_for("pipe"), HasSubstr("pipe: is no regular file"));
}

TEST(OpenOwnFile, RefusesAFolderInItsPlace) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "name");
  for (const ExistingFile existing : {ExistingFile::keep, ExistingFile::replace}) {
    EXPECT_THAT(message_of<InvalidInput>([&] { open_own_file(folder / "name", existing); }),
                HasSubstr("name: cannot be written: "));
  }
}

}  // namespace
}  // namespace mottle
