// Decks with other numbers in them: what changes, what stays, and what cannot be written.
#include "mottle/formats/nastran/rewrite.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/message_of.hpp"
#include "formats/nastran/fields.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

using ::testing::HasSubstr;

/// Writes the decks into a folder of its own.
class RewriteTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("mottle-rewrite-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

const char* const k_start = "BEGIN BULK\nGRID,1\nGRID,2,,1.\n$ a remark, kept\n";
const char* const k_end = "ENDDATA\n";

TEST(NastranReal, IsTheNearestNumberThatTheFieldHolds) {
  EXPECT_EQ(nastran_real(7e10, 8), "7.+10");
  EXPECT_EQ(nastran_real(0.00125, 8), ".00125");
  EXPECT_EQ(nastran_real(-0.5, 8), "-.5");
  EXPECT_EQ(nastran_real(0.0, 8), "0.");
  EXPECT_EQ(nastran_real(1.0, 8), "1.");
  EXPECT_EQ(nastran_real(1234567.0, 8), "1234567.");
}

// Five digits of a positive number always fit into eight characters ("12345.+6", "12345.-6" up to exponents of one
// digit, ".1234-10" four), 11 into sixteen.
TEST(NastranReal, ReadsBackWithinItsDigits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> logarithm(std::log(1e-6), std::log(1e13));
  for (int k = 0; k < 2000; ++k) {
    const double value = std::exp(logarithm(random));
    for (const auto& [width, digits] : {std::pair{8, 5e-5}, std::pair{16, 1e-11}}) {
      const std::string text = nastran_real(value, width);
      double read = 0.0;
      ASSERT_TRUE(nastran::parse_real(text, read)) << text;
      EXPECT_LE(text.size(), static_cast<std::size_t>(width));
      EXPECT_NE(text.find('.'), std::string::npos) << text << " would be an integer";
      EXPECT_NEAR(read / value, 1.0, digits) << text << " for " << value;
    }
  }
}

TEST_F(RewriteTest, ChangesTheFieldAndNoOtherCharacter) {
  const std::string before = std::string(k_start) +
                             "MAT1    1       7.+10           .33     2700.\n"
                             "mat1*   2               7.+10                           .33\n"
                             "*       2700.           $ no label\n"
                             "MAT1,3, 7.+10 ,,.33 , 2700.\r\n" +
                             k_end;
  const std::string after = std::string(k_start) +
                            "MAT1    1       71235.+6        .33     2690.5  \n"
                            "mat1*   2               71234567890.                    .33\n"
                            "*       2700.           $ no label\n"
                            "MAT1,3, 71235.+6 ,,.33 , 2700.\r\n" +
                            k_end;
  const double value = 7.1234567890e10;
  const RewrittenDeck deck = rewrite_nastran_deck(
      write("deck.bdf", before), {},
      {{"MAT1", 1, "E", value}, {"MAT1", 1, "RHO", 2690.5}, {"MAT1", 2, "E", value}, {"MAT1", 3, "E", value}});
  EXPECT_EQ(deck.files.at(0).bytes, after);
  EXPECT_NEAR(deck.rounding, 432110.0 / value, 1e-12);
}

TEST_F(RewriteTest, FindsEachOfSeveralEqualNumbers) {
  const std::string text = std::string(k_start) +
                           "PELAS   7       5.+6                    8       5.+6\n"
                           "PBUSH   9       K       5.+6    5.+6    5.+6\n" +
                           k_end;
  const RewrittenDeck deck =
      rewrite_nastran_deck(write("deck.bdf", text), {}, {{"PELAS", 8, "K", 6e6}, {"PBUSH", 9, "K2", 4e6}});
  EXPECT_EQ(deck.files.at(0).bytes, std::string(k_start) +
                                        "PELAS   7       5.+6                    8       6000000.\n"
                                        "PBUSH   9       K       5.+6    4000000.5.+6\n" +
                                        k_end);
}

TEST_F(RewriteTest, ChangesIncludedFiles) {
  write("numbers.inc", "MAT1,1,7.+10,,.33\n");
  const RewrittenDeck deck = rewrite_nastran_deck(
      write("deck.bdf", std::string(k_start) + "INCLUDE 'numbers.inc'\n" + k_end), {}, {{"MAT1", 1, "E", 6e10}});
  ASSERT_EQ(deck.files.size(), 2U);
  EXPECT_EQ(deck.files[1].bytes, "MAT1,1,6.+10,,.33\n");
}

TEST_F(RewriteTest, SaysWhatItCannotWrite) {
  const auto deck = write("deck.bdf", std::string(k_start) + "MAT1\t1\t7.+10\t\t.33\nPELAS,2,100.\n" + k_end);
  EXPECT_THAT(test::message_of<InvalidInput>([&] {
                rewrite_nastran_deck(deck, {}, {{"MAT1", 1, "E", 6e10}});
              }),
              HasSubstr("has tabs"));
  EXPECT_THAT(test::message_of<InvalidInput>([&] {
                rewrite_nastran_deck(deck, {}, {{"MAT1", 5, "E", 6e10}});
              }),
              HasSubstr("'MAT1:5:E': the deck has no such number"));
  EXPECT_THAT(test::message_of<InvalidInput>([&] {
                rewrite_nastran_deck(deck, {}, {{"PELAS", 2, "K2", 1.0}});
              }),
              HasSubstr("the deck has no such number"));
}

}  // namespace
}  // namespace mottle::formats
