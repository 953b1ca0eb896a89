// MATLAB files that claim, pack or nest more than they hold: each is refused, or read past, before memory is asked for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <functional>
#include <random>

#include "core/message_of.hpp"
#include "formats/mat_bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/mat.hpp"

namespace mottle::formats {
namespace {

using test::mat_array;
using test::mat_element;
using test::mat_file;
using test::mat_packed;
using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string k_three = mat_element(9, test::bytes_of(std::vector<double>{1.0, 2.0, 3.0}));
const std::string k_sound = mat_array(6, {3, 1}, "f1", k_three);

struct Hostile {
  const char* name;
  std::function<std::string()> bytes;
  const char* message;  ///< empty: read, with f1 alone
};

long peak_kilobytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

class HostileMatFile : public ::testing::TestWithParam<Hostile> {};

TEST_P(HostileMatFile, IsRefusedOrReadPast) {
  const std::string bytes = GetParam().bytes();
  const long before = peak_kilobytes();
  if (*GetParam().message == '\0') {
    const auto variables = parse_mat(bytes, "hostile.mat");
    EXPECT_EQ(variables.size(), 1U);
    EXPECT_THAT(variables.at("f1").numbers, ElementsAre(1.0, 2.0, 3.0));
  } else {
    EXPECT_THAT(message_of<FormatError>([&] { parse_mat(bytes, "hostile.mat"); }),
                ::testing::AllOf(HasSubstr("hostile.mat: "), HasSubstr(GetParam().message)));
  }
  constexpr long k_max_kilobytes = 200000;  // the files have 3 MB at most, and claim 2 GB and more
  EXPECT_LT(peak_kilobytes() - before, k_max_kilobytes);
}

/// What is packed has a sum at its end: no damage is read as other numbers.
TEST(PackedMatFile, AFlippedBitIsSeen) {
  const std::string sound = mat_file(mat_packed(k_sound, static_cast<std::uint32_t>(k_sound.size() - 8)));
  ASSERT_THAT(parse_mat(sound, "sound.mat").at("f1").numbers, ElementsAre(1.0, 2.0, 3.0));
  constexpr std::size_t k_packed = 128 + 8;
  for (std::size_t bit = 8 * k_packed; bit < 8 * sound.size(); ++bit) {
    std::string bytes = sound;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
    try {
      const auto variables = parse_mat(bytes, "flipped.mat");
      EXPECT_THAT(variables.at("f1").numbers, ElementsAre(1.0, 2.0, 3.0)) << "bit " << bit;
    } catch (const FormatError&) {
      continue;
    }
  }
}

/// Bytes that cannot be packed.
std::string noise(std::size_t size) {
  std::string bytes(size, '\0');
  std::minstd_rand next;
  for (char& byte : bytes) byte = static_cast<char>(next() >> 8U);
  return bytes;
}

std::string nested_cells(int levels) {
  const std::string number = mat_array(6, {1, 1}, "", mat_element(9, std::string(8, '\0')));
  const std::string head = mat_array(1, {1, 1}, "", "").substr(8);
  std::string inside = number;
  std::vector<std::string> tags;
  for (int k = 0; k < levels; ++k) {
    tags.push_back(test::mat_tag(14, head.size() + inside.size() + k * (head.size() + 8)) + head);
  }
  std::string bytes;
  for (auto tag = tags.rbegin(); tag != tags.rend(); ++tag) bytes += *tag;
  return bytes + inside;
}

constexpr std::uint32_t k_huge = 2147483647;

INSTANTIATE_TEST_SUITE_P(
    Files, HostileMatFile,
    ::testing::Values(
        Hostile{"TwoBillionRowsOfNoCharacters",
                [] {
                  return mat_file(mat_array(4, {k_huge, 0}, "s", mat_element(16, "")) + k_sound);
                },
                ""},
        Hostile{"TwoBillionCharacters",
                [] {
                  return mat_file(mat_array(4, {k_huge, 1}, "s", mat_element(16, "ab")) + k_sound);
                },
                "'s' holds 2 numbers"},
        Hostile{"NumbersThatAreNotThere",
                [] {
                  return mat_file(mat_array(6, {k_huge, k_huge}, "f1", k_three));
                },
                "'f1' holds 3 numbers"},
        Hostile{"ANegativeSize",
                [] {
                  return mat_file(mat_array(6, {0xfffffffd, 1}, "f1", k_three));
                },
                "negative"},
        Hostile{"SizesWhoseProductOverflows",
                [] {
                  return mat_file(mat_array(6, {0x40000000, 0x40000000, 16}, "f1", k_three));
                },
                "'f1' holds 3 numbers"},
        Hostile{"AThousandDimensions",
                [] { return mat_file(mat_array(6, std::vector<std::uint32_t>(1000, 1), "f1", k_three)); }, "head"},
        Hostile{"CellsThatAreNotThere",
                [] {
                  return mat_file(mat_array(1, {k_huge, 1}, "dofs", "") + k_sound);
                },
                "ends within a variable"},
        Hostile{"CellsNested50000Deep", [] { return mat_file(nested_cells(50000) + k_sound); }, ""},
        Hostile{"AnElementLongerThanTheFile",
                [] { return mat_file(test::mat_tag(14, 0xffffffff) + std::string(64, '\0')); },
                "bytes, and 64 are left"},
        Hostile{"ThreeMegabytesThatUnpackToGigabytes",
                [] {
                  return mat_file(mat_packed(mat_array(6, {375 << 20, 1}, "f1", noise(3 << 20)), 0xb0000000));
                },
                "its variables take more than"},
        Hostile{"APackedVariableThatClaimsMoreThanDeflateCanPack",
                [] { return mat_file(mat_packed(k_sound, 64 << 20)); }, "claims more than it can hold"},
        Hostile{"APackedVariableThatIsCutShort", [] { return mat_file(mat_packed(k_sound, 20000)); },
                "shorter than it says"},
        Hostile{"PackedBytesThatAreNone", [] { return mat_file(mat_element(15, "no deflate stream")); },
                "cannot be unpacked"},
        Hostile{"Version4WithSizesBeyondTheFile",
                [] {
                  return test::bytes_of(std::vector<std::uint32_t>{0, k_huge, k_huge, 0, 3}) + std::string("f1\0", 3);
                },
                "the file ends before"},
        Hostile{"Version4WithANameBeyondTheFile",
                [] {
                  return test::bytes_of(std::vector<std::uint32_t>{0, 1, 1, 0, 4000}) + "f1";
                },
                "ends within a name"},
        Hostile{"Version4WithANegativeNameLength",
                [] {
                  return test::bytes_of(std::vector<std::uint32_t>{0, 1, 1, 0, 0xffffffff}) + "f1";
                },
                "is no MATLAB file"},
        Hostile{"Version73WithoutHdf5", [] { return mat_file(std::string(1024, '\0'), 2); }, "is not an HDF5 file"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(ReadMat, ShowsCodesThatAreNoCharactersAsQuestionMarks) {
  const std::string text = test::bytes_of(std::vector<std::uint32_t>{1, 1, 3, 0, 2}) + std::string("s\0", 2) +
                           test::bytes_of(std::vector<double>{97.0, -1e300, 98.0});
  EXPECT_THAT(parse_mat(text, "text.mat").at("s").texts, ElementsAre("a?b"));
}

}  // namespace
}  // namespace mottle::formats
