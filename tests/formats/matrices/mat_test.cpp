// MATLAB files that SciPy and Octave wrote; tests/formats/mat/make.py and make.m say how.
#include "mottle/formats/matrices/mat.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::filesystem::path k_folder = MOTTLE_SOURCE_DIR "/tests/formats/mat";

class MatFiles : public ::testing::TestWithParam<const char*> {};

TEST_P(MatFiles, GiveNumbersAndTexts) {
  const auto variables = read_mat((k_folder / GetParam()).string());
  const MatVariable& frequencies = variables.at("frequencies");
  EXPECT_THAT(frequencies.sizes, ElementsAre(2, 2));
  EXPECT_EQ(frequencies.numbers[1], 10.75);
  EXPECT_TRUE(std::isnan(frequencies.numbers[3]));
  EXPECT_THAT(variables.at("shapes").sizes, ElementsAre(3, 2, 2));
  EXPECT_EQ(variables.at("shapes").numbers[11], 11.0 / 8);
  EXPECT_THAT(variables.at("dofs").texts, ElementsAre("101:+Z", "7:-X", "m1"));
  EXPECT_FALSE(variables.contains("nested"));
}

INSTANTIATE_TEST_SUITE_P(Programs, MatFiles,
                         ::testing::Values("scipy-v5.mat", "scipy-v7.mat", "octave-v6.mat", "octave-v7.mat"));

TEST(ReadMat, ReadsWholeNumbersTextsAndVersionFour) {
  const auto variables = read_mat((k_folder / "scipy-v5.mat").string());
  EXPECT_THAT(variables.at("counts").numbers, ElementsAre(1.0, 2.0));
  EXPECT_THAT(variables.at("note").texts, ElementsAre("a text"));
  const auto old = read_mat((k_folder / "octave-v4.mat").string());
  EXPECT_THAT(old.at("f1").numbers, ElementsAre(10.5, 10.75));
}

TEST(ReadMat, RefusesWhatIsNoMatlabFileOrIsCutShort) {
  EXPECT_THAT(test::message_of<FormatError>([] { read_mat((k_folder / "make.m").string()); }), HasSubstr("make.m: "));
  std::ifstream stream(k_folder / "scipy-v7.mat", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const test::TemporaryFolder folder;
  const std::filesystem::path cut = folder.path() / "cut.mat";
  std::ofstream(cut, std::ios::binary) << bytes.substr(0, 150);
  EXPECT_THAT(test::message_of<FormatError>([&] { read_mat(cut.string()); }), HasSubstr("cut.mat: "));
}

}  // namespace
}  // namespace mottle::formats
