#include "mottle/formats/tables/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/message_of.hpp"

namespace mottle::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Every number of a table [row x column].
Eigen::MatrixXd numbers_of(const std::string& bytes) {
  const CsvTable table = parse_csv(bytes, "tests.csv");
  Eigen::MatrixXd numbers(table.rows.size(), table.header.size());
  for (Eigen::Index column = 0; column < numbers.cols(); ++column) {
    numbers.col(column) = numbers_of_column(table, static_cast<int>(column));
  }
  return numbers;
}

std::string refusal(const std::string& bytes) {
  return test::message_of<FormatError>([&] { numbers_of(bytes); });
}

const Eigen::MatrixXd k_two_by_two = (Eigen::MatrixXd(2, 2) << 1.5, -2.0, 3e3, 4.0).finished();

TEST(ParseCsv, ReadsHeaderAndRows) {
  const CsvTable table = parse_csv("f1,f2\n1.5,-2\n3e3,4\n", "tests.csv");
  EXPECT_THAT(table.header, ElementsAre("f1", "f2"));
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre("1.5", "-2"), ElementsAre("3e3", "4")));
  EXPECT_THAT(table.lines, ElementsAre(2, 3));
  EXPECT_EQ(table.file, "tests.csv");
}

TEST(ParseCsv, TakesTheSeparatorFromTheHeader) {
  EXPECT_EQ(numbers_of("f1,f2\n1.5,-2\n3e3,4\n"), k_two_by_two);
  EXPECT_EQ(numbers_of("f1;f2\n1.5;-2\n3e3;4\n"), k_two_by_two);
  EXPECT_EQ(numbers_of("f1\tf2\n1.5\t-2\n3e3\t4\n"), k_two_by_two);
}

TEST(ParseCsv, TakesNoSeparatorFromInsideQuotes) {
  EXPECT_THAT(parse_csv("\"f1; raw\",f2\n1,2\n", "t").header, ElementsAre("f1; raw", "f2"));
  EXPECT_THAT(parse_csv("\"f1,raw\";f2\n1;2\n", "t").header, ElementsAre("f1,raw", "f2"));
}

TEST(ParseCsv, ReadsQuotedCells) {
  EXPECT_THAT(parse_csv("\"a, b\",\"say \"\"x\"\"\"\n\"1\",2\n", "t").header, ElementsAre("a, b", "say \"x\""));
  EXPECT_EQ(numbers_of("f1,f2\n\"1.5\",\"-2\"\n3e3,4\n"), k_two_by_two);
}

TEST(ParseCsv, ReadsLineEndsOfWindows) {
  EXPECT_EQ(numbers_of("f1,f2\r\n1.5,-2\r\n3e3,4\r\n"), k_two_by_two);
}

TEST(ParseCsv, SkipsAByteOrderMark) {
  EXPECT_THAT(parse_csv("\xEF\xBB\xBF"
                        "f1,f2\n1,2\n",
                        "t")
                  .header,
              ElementsAre("f1", "f2"));
}

TEST(ParseCsv, NeedsNoLineEndBehindTheLastRow) {
  EXPECT_EQ(numbers_of("f1,f2\n1.5,-2\n3e3,4"), k_two_by_two);
}

TEST(ParseCsv, SkipsCommentsAndEmptyLines) {
  EXPECT_EQ(numbers_of("# ten specimens\n\nf1,f2\n  # first\n1.5,-2\n \n3e3,4\n#\n"), k_two_by_two);
}

TEST(ParseCsv, CountsSkippedLines) {
  EXPECT_THAT(parse_csv("# head\n\nf1\n1\n# more\n2\n", "t").lines, ElementsAre(4, 6));
}

TEST(ParseCsv, NumbersRowsWithTheEmptyLinesBetweenThemAndWithoutRemarks) {
  EXPECT_EQ(parse_csv("\na\n1\n\n# remark\n2\n\n", "a.csv").numbers, (std::vector<int>{1, 3}));
  EXPECT_EQ(parse_csv("5,6\n\n7,8\n", "a.csv", HeaderRule::may_be_missing).numbers, (std::vector<int>{1, 3}));
}

TEST(ParseCsv, TrimsBlanksAroundCells) {
  EXPECT_THAT(parse_csv(" f1 , f2\t\n 1 ,2 \n", "t").rows, ElementsAre(ElementsAre("1", "2")));
}

TEST(ParseCsv, ReadsAHeaderWithoutRows) {
  EXPECT_THAT(parse_csv("f1,f2\n", "t").rows, IsEmpty());
}

TEST(ParseCsv, KeepsARowThatHoldsNothingButSeparators) {
  EXPECT_EQ(parse_csv("a,b,c\n,,\n1,2,3\n", "t").rows.size(), 2U);
  EXPECT_EQ(parse_csv("a\tb\tc\n\t\t\n1\t2\t3\n", "t").rows.size(), 2U);
}

// A file may not make the reader hang: comparing each name with every other would take minutes here.
TEST(ParseCsv, ReadsAHeaderOfManyColumns) {
  std::string header = "c0";
  for (int column = 1; column < 300000; ++column) header += ",c" + std::to_string(column);
  EXPECT_EQ(parse_csv(header, "t").header.size(), 300000U);
}

TEST(ParseCsv, FindsAColumnByName) {
  const CsvTable table = parse_csv("f1,f2\n1,2\n", "t");
  EXPECT_EQ(table.find("f2"), 1);
  EXPECT_EQ(table.find("f3"), -1);
}

TEST(ParseCsv, RefusesAFileWithoutAHeader) {
  const std::string message = "tests.csv: is empty; a header line with column names is needed";
  EXPECT_EQ(refusal(""), message);
  EXPECT_EQ(refusal("\xEF\xBB\xBF"), message);
  EXPECT_EQ(refusal("# a comment\n\n"), message);
}

TEST(ParseCsv, RefusesAColumnWithoutAName) {
  EXPECT_EQ(refusal("# x\nf1,,f3\n1,2,3\n"), "tests.csv:2: column 2 has no name");
  EXPECT_EQ(refusal("f1,f2,\n1,2,3\n"), "tests.csv:1: column 3 has no name");
  EXPECT_EQ(refusal("\tf1\tf2\n1\t2\t3\n"), "tests.csv:1: column 1 has no name");
  EXPECT_EQ(refusal("f1,\"\"\n1,2\n"), "tests.csv:1: column 2 has no name");
}

TEST(ParseCsv, RefusesARepeatedColumn) {
  EXPECT_EQ(refusal("f1,f2,f1\n1,2,3\n"), "tests.csv:1: column 'f1' is given twice");
}

TEST(ParseCsv, RefusesARowThatIsTooShortOrTooLong) {
  EXPECT_EQ(refusal("f1,f2\n1,2\n3\n"), "tests.csv:3: 1 cells, but the header names 2 columns");
  EXPECT_EQ(refusal("f1,f2\r\n1,2,3\r\n"), "tests.csv:2: 3 cells, but the header names 2 columns");
  EXPECT_EQ(refusal("f1\tf2\n1\t2\t\n"), "tests.csv:2: 3 cells, but the header names 2 columns");
}

TEST(ParseCsv, RefusesAQuoteThatIsNotClosedOnItsLine) {
  EXPECT_EQ(refusal("f1,f2\n1,2\n\"3,4\n"), "tests.csv:3: a quoted cell is not closed on its line");
  EXPECT_EQ(refusal("\"f1,f2\n1,2\n"), "tests.csv:1: a quoted cell is not closed on its line");
}

TEST(NumbersOfColumn, MakesMissingCellsNotANumber) {
  const Eigen::MatrixXd numbers = numbers_of("f1,f2\n,1\nnan,2\nNaN,3\n\"\",4\n5,6\n");
  EXPECT_TRUE(numbers.col(0).head(4).array().isNaN().all());
  EXPECT_EQ(numbers(4, 0), 5.0);
  EXPECT_TRUE(numbers.col(1).allFinite());
}

TEST(NumbersOfColumn, RefusesTextWithItsLineColumnAndCell) {
  const std::string tail = "', which is not a finite number; leave the cell empty where nothing was measured";
  EXPECT_EQ(refusal("f1,f2\n1,2\n# c\n3,4 Hz\n"), "tests.csv:4: column 'f2' holds '4 Hz" + tail);
  EXPECT_EQ(refusal("f1;f2\n1,5;2\n"),
            "tests.csv:2: column 'f1' holds '1,5', which is not a finite number; decimal commas are not read: write a "
            "point");
  EXPECT_EQ(refusal("f1;f2\n1,5,0;2\n"), "tests.csv:2: column 'f1' holds '1,5,0" + tail);
}

TEST(NumbersOfColumn, RefusesWhatIsNoFiniteNumber) {
  for (const std::string cell : {"inf", "-inf", "infinity", "-nan", "1e999", "--1", "+-1", "0x1", "n/a"}) {
    EXPECT_THAT(refusal("f1,f2\n1," + cell + "\n"), ::testing::StartsWith("tests.csv:2: column 'f2' holds '" + cell))
        << cell;
  }
}

}  // namespace
}  // namespace mottle::formats
