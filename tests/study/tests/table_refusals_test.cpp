// Tables of tests that cannot be read or cannot be the model's.
#include <gtest/gtest.h>

#include <numbers>

#include "mottle/study/jobs/diagnose.hpp"
#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::expect_refused;
using test::k_three_masses_tests;
using test::WrongStudy;

WrongStudy wrong_table(const std::string& what, std::string table, std::vector<std::string> says) {
  says.emplace_back("tests.csv");
  return {.what = what, .says = std::move(says), .tests = std::move(table)};
}

/// The good table with another header.
std::string headed(const std::string& header) {
  return edited(k_three_masses_tests, {{"f1,f2,f3", header}});
}

/// The good table with other text in place of the second specimen's f2, which is on line 3.
std::string with_f2(const std::string& cell) {
  return edited(k_three_masses_tests, {{"0.3080098662667982", cell}});
}

/// The good table; in the lines from `first` on, counted from 0, the last cell is `cell` with its comma.
std::string with_last_cells(std::size_t first, const std::string& cell) {
  std::string table;
  const std::vector<std::string> lines = test::lines_of(k_three_masses_tests);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    table += (i < first ? lines[i] : lines[i].substr(0, lines[i].rfind(',')) + cell) + "\n";
  }
  return table;
}

/// The first specimens alone.
std::string first_rows(std::size_t count) {
  std::vector<std::string> lines = test::lines_of(k_three_masses_tests);
  lines.resize(count + 1);
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string six_times(const std::string& row) {
  return fmt::format("f1,f2,f3\n{0}\n{0}\n{0}\n{0}\n{0}\n{0}\n", row);
}

std::vector<std::vector<double>> scaled_rows(double factor) {
  std::vector<std::vector<double>> rows = test::numbers_of(k_three_masses_tests);
  for (auto& row : rows) {
    for (double& value : row) value *= factor;
  }
  return rows;
}

/// The good table with its frequencies times a factor.
std::string in_unit(double factor) {
  return test::csv_text("f1,f2,f3", scaled_rows(factor));
}

constexpr double k_two_pi = 2.0 * std::numbers::pi;

TEST(TestTable, IsRefusedWithTheLineWhereItsHeaderIsWrong) {
  expect_refused({
      wrong_table("a wrong header", headed("freq1,f2,f3"), {"tests.csv:1: ", "'freq1'", "Known: f1, f2, f3"}),
      wrong_table("no header", k_three_masses_tests.substr(k_three_masses_tests.find('\n') + 1),
                  {"tests.csv:1: ", "has no line with the names of the columns", R"(pairing = "frequency")"}),
      wrong_table("no column for an output", with_last_cells(0, ""), {"tests.csv:1: ", "'f3'", "no column"}),
      wrong_table("a column twice", headed("f1,f1,f3"), {"tests.csv:1: ", "'f1'", "twice"}),
      wrong_table("a column without a name", headed("f1,,f3"), {"tests.csv:1: ", "column 2", "name"}),
      wrong_table("no rows", "f1,f2,f3\n", {"no specimen"}),
      wrong_table("only empty rows", "f1,f2,f3\n,,\nnan,nan,nan\n", {"no specimen"}),
      wrong_table("an empty file", "", {"is empty", "header"}),
  });
}

TEST(TestTable, IsRefusedWithTheLineAndColumnOfWhatIsNoNumber) {
  expect_refused({
      wrong_table("a text", with_f2("abc"), {"tests.csv:3: ", "column 'f2'", "'abc'", "not a finite number"}),
      wrong_table("a decimal comma", with_f2("0,3080098662667982"), {"tests.csv:3: ", "4 cells", "3 columns"}),
      wrong_table("a number with a unit", with_f2("0.308 Hz"), {"tests.csv:3: ", "column 'f2'", "'0.308 Hz'"}),
      wrong_table("a frequency of 0", with_f2("0"), {"tests.csv:3: ", "column 'f2'", "greater than 0"}),
      wrong_table("a negative frequency", with_f2("-0.308"), {"tests.csv:3: ", "column 'f2'", "greater than 0"}),
      wrong_table("an infinite value", with_f2("inf"), {"tests.csv:3: ", "column 'f2'", "'inf'"}),
      wrong_table("a number too large for a computer", with_f2("1e999"), {"tests.csv:3: ", "column 'f2'", "'1e999'"}),
      wrong_table("a ragged row", edited(k_three_masses_tests, {{"0.3080098662667982,", ""}}),
                  {"tests.csv:3: ", "2 cells", "3 columns"}),
      wrong_table("a quote that is not closed", with_f2("\"0.308"), {"tests.csv:3: ", "quoted", "not closed"}),
      wrong_table("a frequency that is too large to be squared", with_f2("1e308"),
                  {"tests.csv:3: ", "column 'f2'", "1e+308", "other units"}),
  });
}

TEST(TestTable, IsRefusedWithTheByteThatIsNoText) {
  std::string junk;
  for (int times = 0; times < 8; ++times) {
    for (int byte = 255; byte > 0; --byte) junk += static_cast<char>(byte);
  }
  std::string utf16 = "\xff\xfe";
  for (const char c : k_three_masses_tests) utf16 += {c, '\0'};
  expect_refused({
      wrong_table("binary junk", junk, {"tests.csv:1: ", "0xFF", "UTF-8"}),
      wrong_table("binary zeros", std::string(4096, '\0'), {"tests.csv:1: ", "0x00", "plain text"}),
      wrong_table("UTF-16", utf16, {"tests.csv:1: ", "0xFF", "UTF-8"}),
      wrong_table("Latin-1", with_f2("gem\xe4\xdf"), {"tests.csv:3: ", "0xE4", "UTF-8"}),
  });
}

TEST(TestTable, IsRefusedWhereAnOutputWasNotMeasured) {
  expect_refused({
      wrong_table("never", edited(with_last_cells(0, ","), {{"f1,f2,\n", "f1,f2,f3\n"}}),
                  {"'f3'", "never measured", "[outputs]"}),
      {.what = "once", .says = {"study.toml:31: test: ", "'f3'", "measured once"}, .tests = with_last_cells(2, ",")},
  });
}

TEST(TestTable, IsRefusedInAnotherUnitWithTheFactor) {
  std::string with_gaps = "f1,f2,f3\n";
  for (const auto& row : scaled_rows(k_two_pi)) {
    const bool is_whole = test::lines_of(with_gaps).size() % 2 == 1;
    with_gaps += is_whole ? fmt::format("{}\n", fmt::join(row, ",")) : fmt::format("{},{},\n", row[0], row[1]);
  }
  expect_refused({
      wrong_table("rad/s", in_unit(k_two_pi), {"times the model's", "2 pi", "rad/s", "f1 1.0", "against 0.2"}),
      wrong_table("divided by 2 pi", in_unit(1.0 / k_two_pi), {"1/(2 pi)", "divided by 2 pi twice"}),
      wrong_table("mHz", in_unit(1000.0), {"near 1000", "mHz"}),
      wrong_table("kHz", in_unit(0.001), {"near 1/1000", "kHz"}),
      wrong_table("per minute", in_unit(60.0), {"factor is near 60"}),
      wrong_table("rad/s with gaps", with_gaps, {"2 pi"}),
  });
}

TEST(TestTable, IsRefusedInAnotherUnitByADiagnosisToo) {
  test::StudyFolder folder;
  folder.write("tests.csv", in_unit(k_two_pi));
  const std::string message = test::message_of<InvalidInput>([&] { (void)diagnose(folder.study(), {}); });
  EXPECT_EQ(folder.without_path(message), folder.refusal());
}

TEST(TestTable, IsRefusedWhereItsCovarianceIsSingular) {
  const std::string singular =
      "f1,f2,f3\n0.1,0.2,0.40\n0.2,0.4,0.41\n0.3,0.6,0.42\n0.4,0.8,0.43\n0.5,1.0,0.44\n0.6,1.2,0.45\n";
  std::vector<std::vector<double>> constant = scaled_rows(1.0);
  for (auto& row : constant) row[0] = 0.125;
  const std::vector<test::TextChange> euclidean{{R"("mahalanobis")", R"("euclidean")"}};
  expect_refused({
      {"one specimen for mares", {}, {"1 specimen", "at least 2", "deterministic"}, "method = ", first_rows(1)},
      {"fewer specimens than outputs",
       {},
       {"covariance", "3 outputs", "3 specimens", "singular", "more specimens"},
       "[test]",
       first_rows(3)},
      {"outputs that go together", {}, {"covariance", "singular", "leave outputs out"}, "[test]", singular},
      {"specimens that are all the same", {}, {"covariance", "singular"}, "[test]", six_times("0.1,0.2,0.3")},
      {"no scatter for the Euclidean weight", euclidean, {"singular"}, "[test]", six_times("0.125,0.25,0.5")},
      {"one output without scatter", {}, {"singular"}, "[test]", test::csv_text("f1,f2,f3", constant)},
      {"no scatter but for rounding", euclidean, {"singular"}, "[test]", six_times("0.1,0.2,0.3")},
  });
}

TEST(TestTable, IsRefusedWithRepeatsOfNothing) {
  const test::StudyFolder folder;
  folder.change({{R"("tests.csv")", "\"tests.csv\"\nrepeatability = \"repeats.csv\""}});
  folder.write("repeats.csv", "specimen,f1,f2,f3\na,0.1,0.2,0.3\nb,0.1,0.2,0.3\n");
  test::expect_message(folder.refusal(), {"repeats.csv", "'f1'", "measured twice on no specimen"});
}

}  // namespace
}  // namespace mottle::study
