#include "mottle/core/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/message_of.hpp"

namespace mottle {
namespace {

using test::message_of;

enum class Weight { mahalanobis, euclidean };

struct Settings {
  double tolerance = 0.01;
  int iterations = 30;
  int samples = 1000;
  double fraction = 0.0;  // automatic
  bool is_damped = true;
  Weight weight = Weight::mahalanobis;
};

OptionTable<Settings> table() {
  OptionTable<Settings> options;
  options
      .number("tolerance", &Settings::tolerance, {.lower = 0.0, .upper = 1.0, .excludes_lower = true}, "-",
              "When to stop.")
      .integer("iterations", &Settings::iterations, {.lower = 1, .upper = 500}, "-", "How often at most.")
      .integer("samples", &Settings::samples, {.lower = 1}, "-", "How many.")
      .number_or("fraction", &Settings::fraction, {.lower = 0.1, .upper = 0.9}, "automatic", 0.0, "How much is kept.")
      .flag("damped", &Settings::is_damped, "Whether steps are damped.")
      .choice("weight", &Settings::weight, {{"mahalanobis", Weight::mahalanobis}, {"euclidean", Weight::euclidean}},
              "The norm.");
  return options;
}

Settings read(const OptionValues& values) {
  return table().read(values, "study.toml: [update]");
}

std::string refusal(const std::string& name, const OptionValue& value) {
  return message_of<InvalidInput>([&] { read({{name, value}}); });
}

TEST(OptionTable, ReadsEveryKindOfField) {
  const Settings settings = read(
      {{"tolerance", 0.5}, {"iterations", std::int64_t{7}}, {"damped", false}, {"weight", std::string("euclidean")}});
  EXPECT_EQ(settings.tolerance, 0.5);
  EXPECT_EQ(settings.iterations, 7);
  EXPECT_FALSE(settings.is_damped);
  EXPECT_EQ(settings.weight, Weight::euclidean);
}

TEST(OptionTable, ReadsANumberOrTheWordThatStandsForOne) {
  EXPECT_EQ(read({{"fraction", 0.3}}).fraction, 0.3);
  EXPECT_EQ(read({{"fraction", std::string("automatic")}}).fraction, 0.0);
  EXPECT_THAT(refusal("fraction", std::string("most")), ::testing::HasSubstr("allowed is \"automatic\" | >= 0.1"));
  EXPECT_NE(refusal("fraction", 0.0), "");
  EXPECT_EQ(read(table().values(Settings{})).fraction, 0.0);
}

TEST(OptionTable, KeepsTheDefaultOfWhatIsNotGiven) {
  const Settings settings = read({{"iterations", std::int64_t{7}}});
  EXPECT_EQ(settings.tolerance, Settings{}.tolerance);
  EXPECT_EQ(settings.weight, Settings{}.weight);
}

TEST(OptionTable, ReadsAWholeNumberWhereARealIsAllowed) {
  EXPECT_EQ(read({{"tolerance", std::int64_t{1}}}).tolerance, 1.0);
}

TEST(OptionTable, RefusesARealWhereAWholeNumberIsNeeded) {
  EXPECT_EQ(refusal("iterations", 7.5),
            "study.toml: [update] iterations = 7.5: allowed is whole number, >= 1 and <= 500");
  EXPECT_EQ(refusal("iterations", 8.0),
            "study.toml: [update] iterations = 8.0: allowed is whole number, >= 1 and <= 500");
}

TEST(OptionTable, RefusesAWholeNumberThatNoIntHolds) {
  EXPECT_THAT(refusal("samples", std::int64_t{5'000'000'000}), ::testing::HasSubstr("samples = 5000000000: allowed"));
  EXPECT_EQ(read({{"samples", std::int64_t{std::numeric_limits<int>::max()}}}).samples,
            std::numeric_limits<int>::max());
}

TEST(OptionTable, RefusesANumberOutsideItsRange) {
  EXPECT_EQ(refusal("tolerance", 1.5), "study.toml: [update] tolerance = 1.5: allowed is > 0 and <= 1");
  EXPECT_EQ(refusal("tolerance", 0.0), "study.toml: [update] tolerance = 0: allowed is > 0 and <= 1");
}

TEST(OptionTable, RefusesANumberThatIsNotFinite) {
  EXPECT_THAT(refusal("tolerance", std::numeric_limits<double>::quiet_NaN()), ::testing::HasSubstr("= nan: allowed"));
}

TEST(OptionTable, RefusesAValueOfAnotherType) {
  EXPECT_EQ(refusal("damped", std::int64_t{1}), "study.toml: [update] damped = 1: allowed is true | false");
  EXPECT_EQ(refusal("tolerance", std::string("0.5")),
            "study.toml: [update] tolerance = \"0.5\": allowed is > 0 and <= 1");
  EXPECT_THAT(refusal("weight", true), ::testing::HasSubstr("weight = true: allowed"));
}

TEST(OptionTable, NamesTheChoicesWhereAnotherWasGiven) {
  EXPECT_EQ(refusal("weight", std::string("manhattan")),
            "study.toml: [update] weight = \"manhattan\": allowed is \"mahalanobis\" | \"euclidean\"");
}

TEST(OptionTable, ShowsControlCharactersOfAText) {
  EXPECT_THAT(refusal("weight", std::string("man\0\n", 5)), ::testing::HasSubstr("\"man\\u0000\\u000A\": allowed is"));
}

TEST(OptionTable, SuggestsTheNearestNameForAnUnknownOne) {
  EXPECT_THAT(refusal("toleranse", 0.5), ::testing::HasSubstr("did you mean 'tolerance'?"));
}

TEST(OptionTable, DescribesEveryFieldInItsOrderWithItsDefault) {
  std::vector<std::string> lines;
  for (const OptionDescription& option : table().describe())
    lines.push_back(option.name + " = " + option.default_value);
  EXPECT_THAT(lines, ::testing::ElementsAre("tolerance = 0.01", "iterations = 30", "samples = 1000",
                                            "fraction = \"automatic\"", "damped = true", "weight = \"mahalanobis\""));
}

TEST(OptionTable, ReadsBackTheValuesInForce) {
  Settings settings;
  settings.tolerance = 0.3;
  settings.weight = Weight::euclidean;
  const Settings copy = read(table().values(settings));
  EXPECT_EQ(copy.tolerance, 0.3);
  EXPECT_EQ(copy.weight, Weight::euclidean);
}

TEST(OptionRange, SaysInWordsWhatItContains) {
  EXPECT_EQ(OptionRange{}.text(), "any number");
  EXPECT_EQ((OptionRange{.lower = 1.0}.text()), ">= 1");
  EXPECT_EQ((OptionRange{.lower = 0.0, .excludes_lower = true}.text()), "> 0");
  EXPECT_EQ((OptionRange{.upper = 2.5}.text()), "<= 2.5");
}

TEST(OptionRange, HoldsItsEndsUnlessTheLowerIsExcluded) {
  const OptionRange closed{.lower = 0.0, .upper = 1.0};
  EXPECT_TRUE(closed.contains(0.0));
  EXPECT_TRUE(closed.contains(1.0));
  EXPECT_FALSE((OptionRange{.lower = 0.0, .excludes_lower = true}.contains(0.0)));
}

TEST(OptionRange, HoldsNoInfiniteNumber) {
  EXPECT_FALSE(OptionRange{}.contains(std::numeric_limits<double>::infinity()));
}

// TOML 1.0, basic strings: quotation mark and backslash are escaped.
TEST(OptionText, EscapesTextAsAStudyFileNeedsIt) {
  EXPECT_EQ(option_text(std::string("a \"b\" c\\d")), "\"a \\\"b\\\" c\\\\d\"");
}

}  // namespace
}  // namespace mottle
