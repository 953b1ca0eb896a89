#include "mottle/core/text.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace mottle {
namespace {

double parsed(std::string_view text) {
  double value = 12345.0;
  return parse_number(text, value) ? value : std::numeric_limits<double>::quiet_NaN();
}

bool is_refused(std::string_view text) {
  double value = 0.0;
  return !parse_number(text, value);
}

TEST(Join, PutsTheSeparatorBetweenPartsOnly) {
  EXPECT_EQ(join({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(join({"a", "b"}, " | "), "a | b");
  EXPECT_EQ(join({"a"}), "a");
  EXPECT_EQ(join({}), "");
}

// Counted by hand; kitten - sitting is the textbook's case.
TEST(EditDistance, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("stifness", "stiffness"), 1);
  EXPECT_EQ(edit_distance("stiffness", "stifness"), 1);
  EXPECT_EQ(edit_distance("mass", "mess"), 1);
  EXPECT_EQ(edit_distance("saeed", "seed"), 1);
  EXPECT_EQ(edit_distance("maen", "mean"), 1);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("abc", ""), 3);
  EXPECT_EQ(edit_distance("abc", "abc"), 0);
}

// The unrestricted distance would be 2 (swap, then insert between): the two differ here first.
TEST(EditDistance, DoesNotEditBetweenSwappedLetters) {
  EXPECT_EQ(edit_distance("ca", "abc"), 3);
}

TEST(EditDistance, IsTheSameInBothDirections) {
  const std::vector<std::string> words{"max_iterations", "iterations", "maximum", "tolerance", "seed", "k1", ""};
  for (const std::string& a : words) {
    for (const std::string& b : words) EXPECT_EQ(edit_distance(a, b), edit_distance(b, a)) << a << " - " << b;
  }
}

TEST(NearestName, IsTheCandidateWithTheFewestEdits) {
  EXPECT_EQ(nearest_name("iteration", {"iterator", "iterations", "seed"}), "iterations");
}

TEST(NearestName, IsEmptyWhereNoCandidateIsMeant) {
  EXPECT_EQ(nearest_name("tolerance", {"seed", "iterations"}), "");
  EXPECT_EQ(nearest_name("tolerance", {}), "");
}

TEST(NearestName, SharesALetterWithAShortName) {
  EXPECT_EQ(nearest_name("k1", {"m2"}), "");
  EXPECT_EQ(nearest_name("k1", {"m2", "k2"}), "k2");
}

TEST(NearestName, IsNotSoughtForANameWithoutEnd) {
  // Comparing two such names would take 10^12 steps.
  const std::string endless(1000000, 'k');
  EXPECT_EQ(nearest_name(endless, {endless + "1"}), "");
  EXPECT_EQ(nearest_name("k1", {endless, "k2"}), "k2");
}

TEST(NestsDeeperThan, CountsBracketsOutsideOfTexts) {
  EXPECT_FALSE(nests_deeper_than(R"([{"a": []}, [[]]])", 3));
  EXPECT_TRUE(nests_deeper_than(R"([{"a": []}, [[]]])", 2));
  EXPECT_FALSE(nests_deeper_than(R"(["[[[", "\"[[[", "\\"])", 1));
  EXPECT_TRUE(nests_deeper_than(R"(["\\", [[]]])", 2));
  EXPECT_TRUE(nests_deeper_than(std::string(200000, '['), 100));
}

TEST(UnknownNameMessage, NamesTheNearestAndAllKnown) {
  EXPECT_EQ(unknown_name_message("key", "stifness", {"mass", "stiffness"}),
            "key 'stifness' is not known here; did you mean 'stiffness'? Known: mass, stiffness");
}

TEST(UnknownNameMessage, SuggestsNothingWhereNothingIsNear) {
  EXPECT_EQ(unknown_name_message("key", "seed", {"mass"}), "key 'seed' is not known here. Known: mass");
  EXPECT_EQ(unknown_name_message("key", "seed", {}), "key 'seed' is not known here. Known: none");
}

TEST(NumberText, IsShort) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(-3.0), "-3");
  EXPECT_EQ(number_text(1e300), "1e+300");
}

TEST(NumberText, ReadsBackAsTheSameBits) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20000; ++i) {
    const auto value = std::bit_cast<double>(static_cast<std::uint64_t>(random()));
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(parsed(number_text(value))), std::bit_cast<std::uint64_t>(value)) << value;
  }
}

TEST(ParseNumber, ReadsDecimalNumbers) {
  EXPECT_EQ(parsed("1.5"), 1.5);
  EXPECT_EQ(parsed("-2"), -2.0);
  EXPECT_EQ(parsed("+2.5e-3"), 2.5e-3);
  EXPECT_EQ(parsed(".5"), 0.5);
  EXPECT_EQ(parsed("5."), 5.0);
  EXPECT_EQ(parsed("1E3"), 1000.0);
}

TEST(ParseNumber, AllowsBlanksAroundTheNumber) {
  EXPECT_EQ(parsed(" \t1.5 \r"), 1.5);
}

TEST(ParseNumber, ReadsTheSmallestDenormalAndTheLargestNumber) {
  EXPECT_EQ(parsed("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(parsed("1.7976931348623157e308"), std::numeric_limits<double>::max());
}

TEST(ParseNumber, RefusesWhatIsNotOneNumber) {
  for (const char* text :
       {"", " ", "abc", "1.5x", "1 2", "1,5", "--1", "++1", "+-1", "-+1", "+", "1e", "0x10", "1e400"}) {
    EXPECT_TRUE(is_refused(text)) << '\'' << text << '\'';
  }
}

TEST(MatchesPattern, StarsStandForAnyCharactersAndQuestionMarksForOne) {
  EXPECT_TRUE(matches_pattern("f12", "f*"));
  EXPECT_TRUE(matches_pattern("f", "f*"));
  EXPECT_TRUE(matches_pattern("phi1:m2", "phi*:m2"));
  EXPECT_TRUE(matches_pattern("phi1:m2", "phi?:*"));
  EXPECT_TRUE(matches_pattern("aab", "*ab"));
  EXPECT_TRUE(matches_pattern("", "*"));
  EXPECT_FALSE(matches_pattern("phi1:m2", "f*"));
  EXPECT_FALSE(matches_pattern("f12", "f?"));
  EXPECT_FALSE(matches_pattern("f1", "f1?"));
  EXPECT_FALSE(matches_pattern("f12", "f1"));
}

}  // namespace
}  // namespace mottle
