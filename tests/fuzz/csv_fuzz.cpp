// libFuzzer target for formats/csv: whatever the bytes, parse_csv and numbers_of_column either throw FormatError or
// give a table that keeps its promises and survives being written and read again.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/tables/csv.hpp"

namespace {

void expect(bool claim) {
  if (!claim) std::abort();
}

bool are_same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

Eigen::MatrixXd numbers_of(const mottle::formats::CsvTable& table) {
  Eigen::MatrixXd numbers(table.rows.size(), table.header.size());
  for (Eigen::Index column = 0; column < numbers.cols(); ++column) {
    numbers.col(column) = mottle::formats::numbers_of_column(table, static_cast<int>(column));
  }
  return numbers;
}

void check_table(const mottle::formats::CsvTable& table) {
  expect(!table.header.empty());
  expect(table.rows.size() == table.lines.size());
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    expect(table.rows[row].size() == table.header.size());
    expect(table.lines[row] > (row == 0 ? 1 : table.lines[row - 1]));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  mottle::formats::CsvTable table;
  Eigen::MatrixXd numbers;
  try {
    const auto rule = mottle::formats::HeaderRule::may_be_missing;
    const mottle::formats::CsvTable rows = mottle::formats::parse_csv(bytes, "fuzz.csv", rule);
    expect(rows.has_header || !rows.rows.empty());
    if (!rows.has_header) numbers_of(rows);
  } catch (const mottle::FormatError&) {  // other rows may be no numbers
  }
  try {
    table = mottle::formats::parse_csv(bytes, "fuzz.csv");
    check_table(table);
    numbers = numbers_of(table);
  } catch (const mottle::FormatError&) {
    return 0;
  }
  // From here on nothing may throw.
  const mottle::formats::CsvTable again =
      mottle::formats::parse_csv(mottle::formats::format_csv(table.header, numbers), "again.csv");
  expect(again.header == table.header);
  const Eigen::MatrixXd copy = numbers_of(again);
  expect(copy.rows() == numbers.rows());
  for (Eigen::Index i = 0; i < numbers.size(); ++i) expect(are_same(copy.reshaped()(i), numbers.reshaped()(i)));
  return 0;
}
