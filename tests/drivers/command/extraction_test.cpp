// Modes out of the files of a run. The CalculiX table is what ccx 2.20 printed for a cantilever of solid elements.
#include "mottle/drivers/command/extraction.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/number_pattern.hpp"
#include "mottle/formats/calculix/results.hpp"

namespace {

using mottle::FormatError;
using mottle::InvalidInput;
using mottle::drivers::ExtractedModes;
using mottle::drivers::FrequencyRule;
using mottle::drivers::ShapeRule;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Format = FrequencyRule::Format;

constexpr const char* k_calculix = R"(
     E I G E N V A L U E   O U T P U T

 MODE NO    EIGENVALUE                       FREQUENCY   
                                     REAL PART            IMAGINARY PART
                           (RAD/TIME)      (CYCLES/TIME     (RAD/TIME)


      1   0.1192722E+05   0.1092118E+03   0.1738160E+02   0.0000000E+00
      2   0.2942712E+06   0.5424677E+03   0.8633642E+02   0.0000000E+00
      3   0.4658107E+06   0.6825032E+03   0.1086237E+03   0.0000000E+00

     P A R T I C I P A T I O N   F A C T O R S
)";

class Extraction : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) { mottle::write_file_atomically(folder_ / name, text); }
  ExtractedModes extract(const FrequencyRule& rule, int least = 1) {
    return mottle::drivers::extract_modes(folder_.path(), rule, std::nullopt, least);
  }
  std::vector<double> hertz(const FrequencyRule& rule) {
    std::vector<double> values;
    for (const double lambda : extract(rule).eigenvalues)
      values.push_back(std::sqrt(lambda) / (2.0 * std::numbers::pi));
    return values;
  }

  mottle::test::TemporaryFolder folder_;
};

TEST_F(Extraction, AColumnAfterAMarkerUntilABlankLine) {
  write("plate.dat", k_calculix);
  FrequencyRule rule{.file = "plate.dat", .after = "E I G E N V A L U E   O U T P U T", .line = 7, .column = "4"};
  EXPECT_THAT(hertz(rule), ElementsAre(testing::DoubleNear(17.3816, 1e-9), testing::DoubleNear(86.33642, 1e-9),
                                       testing::DoubleNear(108.6237, 1e-9)));
  rule.quantity = FrequencyRule::Quantity::radians;
  rule.column = "3";
  EXPECT_NEAR(hertz(rule)[0], 17.3816, 1e-5);
  rule.quantity = FrequencyRule::Quantity::eigenvalue;
  rule.column = "2";
  EXPECT_NEAR(hertz(rule)[0], 17.3816, 1e-5);
  rule.modes = 2;
  EXPECT_EQ(hertz(rule).size(), 2U);
}

TEST_F(Extraction, FaultsOfATableAreNamedWithFileAndLine) {
  const FrequencyRule rule{.file = "out", .after = "FREQ", .line = 1, .column = "2"};
  const auto attempt = [&](const std::string& text) {
    write("out", text);
    return [this, rule] { extract(rule, 2); };
  };
  EXPECT_THAT(attempt("FREQ\n1 10.0\n2 nan\n"), ThrowsMessage<FormatError>(HasSubstr("out:3: 'nan' is not a number")));
  EXPECT_THAT(attempt("FREQ\n1 10.0\n2 inf\n"), ThrowsMessage<FormatError>(HasSubstr("out:3: ")));
  EXPECT_THAT(attempt("FREQ\n1 10.0\n2 1x\n"), ThrowsMessage<FormatError>(HasSubstr("out:3: ")));
  EXPECT_THAT(attempt("FREQ\n1 10.0\n2\n"), ThrowsMessage<FormatError>(HasSubstr("out:3: has 1 columns")));
  EXPECT_THAT(attempt("FREQ\n1 10.0\n2 9.0\n"),
              ThrowsMessage<FormatError>(HasSubstr("do not ascend: mode 1 has 10, mode 2 has 9")));
  EXPECT_THAT(attempt("FREQ\n1 -10.0\n2 9.0\n"), ThrowsMessage<FormatError>(HasSubstr("is negative")));
  EXPECT_THAT(attempt("FREQ\n1 10.0\n2 1e200\n"), ThrowsMessage<FormatError>(HasSubstr("1e+200, is too large")));
  EXPECT_THAT(attempt("FREQ\n1 10.0\n"), ThrowsMessage<FormatError>(HasSubstr("1 modes are there, 2 are needed")));
  EXPECT_THAT(attempt("1 10.0\n"), ThrowsMessage<FormatError>(HasSubstr("has no table after 'FREQ'")));
  EXPECT_THAT([&] { extract({.file = "lost"}); }, ThrowsMessage<InvalidInput>(HasSubstr("left no file 'lost'")));
}

TEST_F(Extraction, AFolderOrAPipeIsNoFile) {
  std::filesystem::create_directory(folder_ / "out");
  EXPECT_THAT([&] { extract({.file = "out"}); }, ThrowsMessage<InvalidInput>(HasSubstr("no regular file")));
}

TEST_F(Extraction, EveryMatchOfAPatternIsAMode) {
  write("log", "mode 1: f = 10.5 Hz\nmode 2: f = 20.25 Hz; mode 3: f = 3.0D+01 Hz\r\n");
  EXPECT_THAT(hertz({.file = "log", .format = Format::regex, .pattern = R"(f = (\S+) Hz)"}),
              ElementsAre(testing::DoubleEq(10.5), testing::DoubleEq(20.25), testing::DoubleEq(30.0)));
}

TEST_F(Extraction, APatternTakesTimeInProportionToTheText) {
  // An engine that backtracks takes 2^n steps for the first, and goes as deep as the line is long for the second.
  write("log", std::string(1 << 20, '1') + "x");
  EXPECT_THAT([&] { extract({.file = "log", .format = Format::regex, .pattern = "((1+)+)+$"}); },
              ThrowsMessage<FormatError>(HasSubstr("0 modes are there")));
  EXPECT_THAT([&] { extract({.file = "log", .format = Format::regex, .pattern = "(1*)*g"}); },
              ThrowsMessage<FormatError>(HasSubstr("0 modes are there")));
}

TEST_F(Extraction, AMatchWithoutItsNumberIsNamedWithItsLine) {
  write("log", "f = 10\nf =\n");
  EXPECT_THAT([&] { extract({.file = "log", .format = Format::regex, .pattern = "f =( \\d+)?"}); },
              ThrowsMessage<FormatError>(HasSubstr("log:2: '' is not a number")));
}

TEST(NumberPattern, IsRefusedWhereItIsNoneOrTooLarge) {
  const auto make = [](const std::string& text) { return [text] { mottle::drivers::NumberPattern{text}; }; };
  EXPECT_THAT(make("(a"), ThrowsMessage<InvalidInput>(HasSubstr("is no regular expression")));
  EXPECT_THAT(make("a+"), ThrowsMessage<InvalidInput>(HasSubstr("has no group")));
  EXPECT_THAT(make("(a)\\1"), ThrowsMessage<InvalidInput>(HasSubstr("invalid escape sequence: \\1")));
  EXPECT_THAT(make("(?=a)(b)"), ThrowsMessage<InvalidInput>(HasSubstr("is no regular expression")));
  EXPECT_THAT(make("(((a{1000}){1000}){1000})"), ThrowsMessage<InvalidInput>(HasSubstr("is no regular expression")));
}

TEST(NumberPattern, TakesAnyNumberOfParentheses) {
  const mottle::drivers::NumberPattern pattern(std::string(20000, '(') + "1" + std::string(20000, ')'));
  EXPECT_THAT(pattern.first_groups("1 2 1"), ElementsAre("1", "1"));
}

TEST_F(Extraction, JsonNestedWithoutEndIsRefused) {
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  write("f.json", R"({"f": [1.0], "rest": )" + deep + "}");
  EXPECT_THAT([&] { extract({.file = "f.json", .format = Format::json, .column = "f"}); },
              ThrowsMessage<FormatError>(HasSubstr("f.json: is JSON nested deeper than 100 levels")));
}

TEST_F(Extraction, ColumnsOfCsvAndListsOfJson) {
  write("f.csv", "mode,f\n1,10\n2,20\n");
  EXPECT_THAT(hertz({.file = "f.csv", .format = Format::csv, .column = "f"}),
              ElementsAre(testing::DoubleEq(10.0), testing::DoubleEq(20.0)));
  EXPECT_THAT([&] { extract({.file = "f.csv", .format = Format::csv, .column = "g"}); },
              ThrowsMessage<FormatError>(HasSubstr("f.csv:1: ")));
  write("f.json", R"({"modes": {"f": [10.0, 20]}})");
  EXPECT_THAT(hertz({.file = "f.json", .format = Format::json, .column = "modes.f"}),
              ElementsAre(testing::DoubleEq(10.0), testing::DoubleEq(20.0)));
  write("f.json", R"({"modes": {"f": [10.0, null]}})");
  EXPECT_THAT([&] { extract({.file = "f.json", .format = Format::json, .column = "modes.f"}); },
              ThrowsMessage<FormatError>(HasSubstr("number 2 of 'modes.f' is not a number")));
  write("f.json", R"({"modes": )");
  EXPECT_THAT([&] { extract({.file = "f.json", .format = Format::json, .column = "modes.f"}); },
              ThrowsMessage<FormatError>(HasSubstr("is not JSON")));
}

TEST_F(Extraction, RigidBodyModesMayBeNegativeByRounding) {
  write("out", "-3.04E-08\n 5.5E-09\n 1.0E+06\n");
  const FrequencyRule rule{.file = "out", .quantity = FrequencyRule::Quantity::eigenvalue, .column = "1"};
  EXPECT_EQ(extract(rule).eigenvalues(0), -3.04e-8);
}

TEST_F(Extraction, ShapesFromAMatrixOfDegreesOfFreedom) {
  write("f", "1.0\n2.0\n");
  write("s.csv", "dof,a,b\n1:+X,0.5,-1\n2:+X,1.0,0.25\n");
  const FrequencyRule rule{.file = "f", .column = "1"};
  const ExtractedModes modes = mottle::drivers::extract_modes(folder_.path(), rule, ShapeRule{.file = "s.csv"}, 1);
  EXPECT_THAT(modes.degree_of_freedom_names, ElementsAre("1:+X", "2:+X"));
  EXPECT_EQ(modes.shapes(0, 1), -1.0);
  write("s.csv", "dof,a\n1:+X,0.5\n");
  EXPECT_THAT([&] { mottle::drivers::extract_modes(folder_.path(), rule, ShapeRule{.file = "s.csv"}, 1); },
              ThrowsMessage<FormatError>(HasSubstr("has shapes of 1 modes")));
  write("s.csv", "dof,a,b\n1:+X,0.5,\n");
  EXPECT_THAT([&] { mottle::drivers::extract_modes(folder_.path(), rule, ShapeRule{.file = "s.csv"}, 1); },
              ThrowsMessage<FormatError>(HasSubstr("s.csv:2: ")));
}

TEST_F(Extraction, ShapesFromATableForEachMode) {
  write("f", "1.0\n2.0\n");
  write("s.dat",
        " displacements (vx,vy,vz) for set TOP and time  0.1\n\n  7  1.0E+00 0.0E+00 2.0E+00\n  8  1.5E+00 0.0E+00 "
        "2.5E+00\n\n"
        " displacements (vx,vy,vz) for set TOP and time  0.2\n\n  7 -1.0E+00 0.0E+00 2.0E+00\n  8  1.5E+00 0.0E+00 "
        "3.5E+00\n");
  const ShapeRule shapes{.file = "s.dat", .format = ShapeRule::Format::column, .after = "displacements (vx", .line = 2};
  const ExtractedModes modes = mottle::drivers::extract_modes(folder_.path(), {.file = "f", .column = "1"}, shapes, 2);
  EXPECT_THAT(modes.degree_of_freedom_names, ElementsAre("7:+X", "7:+Y", "7:+Z", "8:+X", "8:+Y", "8:+Z"));
  EXPECT_EQ(modes.shapes(0, 1), -1.0);
  EXPECT_EQ(modes.shapes(5, 1), 3.5);
}

TEST_F(Extraction, ModesOfCalculix) {
  const std::string bar = std::string(MOTTLE_SOURCE_DIR) + "/tests/formats/matrices/bar";
  write("bar.dat", mottle::read_file(bar + ".dat"));
  write("bar.frd", mottle::read_file(bar + ".frd"));
  const FrequencyRule frequencies{.file = "bar.dat", .format = FrequencyRule::Format::calculix};
  const ShapeRule shapes{.file = "bar.frd", .format = ShapeRule::Format::calculix};
  const ExtractedModes modes = mottle::drivers::extract_modes(folder_.path(), frequencies, shapes, 5);
  const std::vector<mottle::formats::CalculixShape> listed =
      mottle::formats::parse_calculix_shapes(mottle::read_file(bar + ".frd"), "bar.frd");
  ASSERT_EQ(modes.shapes.cols(), 5);
  for (Eigen::Index mode = 0; mode < 5; ++mode) {
    const mottle::formats::CalculixShape& shape = listed[static_cast<std::size_t>(mode)];
    EXPECT_NEAR(std::sqrt(modes.eigenvalues(mode)) / (2.0 * std::numbers::pi) / shape.frequency, 1.0, 1e-6);
    for (std::size_t row = 0; row < modes.degree_of_freedom_names.size(); ++row) {
      const std::string& name = modes.degree_of_freedom_names[row];
      EXPECT_EQ(modes.shapes(static_cast<Eigen::Index>(row), mode),
                shape.displacements.at(std::stoi(name))(name.back() - 'X'));
    }
  }
}

/// The last number of a file that was cut short reads as another one.
TEST_F(Extraction, AProgramsFileThatEndsWithinALineIsRefused) {
  std::string bytes = mottle::read_file(std::string(MOTTLE_SOURCE_DIR) + "/tests/formats/matrices/bar.dat");
  const FrequencyRule rule{.file = "bar.dat", .format = FrequencyRule::Format::calculix};
  while (bytes.back() == '\n' || bytes.back() == ' ') bytes.pop_back();
  write("bar.dat", bytes.substr(0, bytes.size() - 3));
  EXPECT_THAT([&] { mottle::drivers::extract_modes(folder_.path(), rule, {}, 1); },
              testing::ThrowsMessage<mottle::FormatError>(testing::HasSubstr("ends within a line")));
}

}  // namespace
