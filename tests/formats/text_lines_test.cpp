#include "mottle/formats/text_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::formats {
namespace {

using test::message_of;
using test::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::StartsWith;

std::vector<std::string> lines_of(LineWalker walker) {
  std::vector<std::string> lines;
  while (walker.next()) {
    lines.emplace_back(walker.line());
    EXPECT_EQ(walker.number(), static_cast<int>(lines.size()));
  }
  EXPECT_FALSE(walker.next()) << "the end is no longer the end";
  return lines;
}

class LinesOfAFile : public ::testing::Test {
 protected:
  LineWalker walk(const std::string& bytes) const {
    write_file_atomically(folder_ / "printed", bytes);
    return {BlockReader(folder_ / "printed"), "printed"};
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(LinesOfAFile, AreThoseOfTheSameTextInMemory) {
  for (const char* text : {"", "\n", "one", "one\n", "one\r\ntwo", "\r\n\r\n\r", "one\n\ntwo\n\n", "a\rb\n"}) {
    EXPECT_EQ(lines_of(walk(text)), lines_of(LineWalker(text))) << '"' << text << '"';
  }
}

TEST_F(LinesOfAFile, HaveNeitherEnd) {
  EXPECT_THAT(lines_of(walk("one\r\ntwo\nthree")), ElementsAre("one", "two", "three"));
}

/// Whatever the size of a block between 2^12 and 2^17, the bytes around its border are here all kinds of a line's end.
TEST_F(LinesOfAFile, GoOnOverTheBordersOfBlocks) {
  for (const std::size_t block : {std::size_t{1} << 12, std::size_t{1} << 16, std::size_t{1} << 17}) {
    for (std::size_t size = block - 3; size <= block + 3; ++size) {
      const std::string text = std::string(size, 'x') + "\r\n\n" + std::string(size, 'y') + "\r\nlast";
      EXPECT_EQ(lines_of(walk(text)), lines_of(LineWalker(text))) << size;
    }
  }
}

TEST_F(LinesOfAFile, MayBeLongerThanABlock) {
  const std::string long_line(3'000'000, 'x');
  EXPECT_THAT(lines_of(walk("one\n" + long_line + "\r\n" + long_line)), ElementsAre("one", long_line, long_line));
}

TEST_F(LinesOfAFile, MayHaveTheStatedLengthAndNoMore) {
  const std::string longest(k_longest_line, 'x');
  EXPECT_EQ(lines_of(walk("one\n" + longest + "\n")).back().size(), k_longest_line);
  for (const char* end : {"x\n", "x"}) {
    EXPECT_THAT(message_of<FormatError>([&] { lines_of(walk("one\n" + longest + end)); }),
                StartsWith("printed:2: the line has more than 16777216 bytes"));
  }
}

TEST_F(LinesOfAFile, StayInPlaceWhenTheWalkerMoves) {
  LineWalker walker = walk("one\ntwo\n");
  ASSERT_TRUE(walker.next());
  LineWalker moved = std::move(walker);
  EXPECT_EQ(moved.line(), "one");
  ASSERT_TRUE(moved.next());
  EXPECT_EQ(moved.line(), "two");
}

}  // namespace
}  // namespace mottle::formats
