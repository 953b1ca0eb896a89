// What format_csv writes, parse_csv reads back bit for bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "mottle/formats/tables/csv.hpp"

namespace mottle::formats {
namespace {

using Limits = std::numeric_limits<double>;

std::vector<std::uint64_t> bits_of(const Eigen::VectorXd& numbers) {
  std::vector<std::uint64_t> bits;
  for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  return bits;
}

Eigen::VectorXd written_and_read(const Eigen::VectorXd& numbers) {
  return numbers_of_column(parse_csv(format_csv({"x"}, numbers), "t"), 0);
}

TEST(FormatCsv, WritesHeaderAndRows) {
  const Eigen::MatrixXd values = (Eigen::MatrixXd(2, 2) << 1.5, -2.0, 0.1, 4.0).finished();
  EXPECT_EQ(format_csv({"f1", "f2"}, values), "f1,f2\n1.5,-2\n0.1,4\n");
}

TEST(FormatCsv, WritesTextColumnsBehindTheNumbers) {
  const Eigen::MatrixXd values = Eigen::Vector2d(1.0, 2.0);
  EXPECT_EQ(format_csv({"f1", "status"}, values, {{"ok", "lost, at 2"}}), "f1,status\n1,ok\n2,\"lost, at 2\"\n");
}

TEST(FormatCsv, LeavesAMissingNumberEmpty) {
  const Eigen::MatrixXd values = (Eigen::MatrixXd(1, 3) << 1.0, Limits::quiet_NaN(), 2.0).finished();
  EXPECT_EQ(format_csv({"a", "b", "c"}, values), "a,b,c\n1,,2\n");
}

TEST(CsvRoundTrip, KeepsEveryBitOfRandomNumbers) {
  std::mt19937_64 random(1);
  Eigen::VectorXd numbers(20000);
  for (double& number : numbers) {
    do {
      number = std::bit_cast<double>(static_cast<std::uint64_t>(random()));
    } while (!std::isfinite(number));
  }
  EXPECT_EQ(bits_of(written_and_read(numbers)), bits_of(numbers));
}

TEST(CsvRoundTrip, KeepsEveryBitOfDenormals) {
  std::mt19937_64 random(2);
  Eigen::VectorXd numbers(2000);
  for (double& number : numbers) number = std::bit_cast<double>(static_cast<std::uint64_t>(random()) >> 12U);
  ASSERT_LT(numbers.maxCoeff(), Limits::min());
  EXPECT_EQ(bits_of(written_and_read(numbers)), bits_of(numbers));
}

// 0.1 + 0.2 and 5e-324 are the textbook's cases; 1/3 and 2/3 need 16 digits, 1 + 2^-52 needs 17.
TEST(CsvRoundTrip, KeepsTheEndsOfTheRangeAndNumbersOfManyDigits) {
  Eigen::VectorXd numbers(10);
  numbers << 0.0, -0.0, Limits::denorm_min(), Limits::min(), Limits::max(), Limits::lowest(), 0.1 + 0.2, 1.0 / 3.0,
      2.0 / 3.0, 1.0 + Limits::epsilon();
  EXPECT_EQ(bits_of(written_and_read(numbers)), bits_of(numbers));
}

TEST(CsvRoundTrip, ReadsSeventeenDigitsToTheNearestNumber) {
  const Eigen::VectorXd numbers =
      numbers_of_column(parse_csv("x\n0.30000000000000004\n2.2250738585072014e-308\n", "t"), 0);
  EXPECT_EQ(numbers(0), 0.1 + 0.2);
  EXPECT_EQ(numbers(1), Limits::min());
}

TEST(CsvRoundTrip, KeepsTheRowsOfAColumnWithMissingNumbers) {
  const Eigen::VectorXd read = written_and_read(Eigen::Vector3d(1.0, Limits::quiet_NaN(), 3.0));
  ASSERT_EQ(read.size(), 3);
  EXPECT_TRUE(std::isnan(read(1)));
}

TEST(CsvRoundTrip, KeepsNamesOfEveryKind) {
  const std::vector<std::string> names{"\xEF\xBB\xBFmark", "#1", "a;b", "a\tb", "a,b", "say \"x\"", "phi1:m2"};
  const Eigen::MatrixXd values = Eigen::MatrixXd::Ones(1, 7);
  EXPECT_EQ(parse_csv(format_csv(names, values), "t").header, names);
}

TEST(CsvRoundTrip, PutsATextOfSeveralLinesOnOne) {
  const CsvTable table = parse_csv(format_csv({"x", "why"}, Eigen::MatrixXd::Ones(1, 1), {{"first\nsecond"}}), "t");
  EXPECT_EQ(table.rows[0][1], "first second");
}

}  // namespace
}  // namespace mottle::formats
