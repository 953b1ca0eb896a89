// Matrices as other programs read them: Matrix Market text and Nastran's OUTPUT4.
// Sources: [Boisvert1996]; [MSC2014], OUTPUT4.
#include <algorithm>
#include <bit>
#include <iterator>

#include "mottle/core/bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"

namespace mottle::formats {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t k_name_length = 8;
constexpr int k_most_short_rows = 65535;  // a string's row and length share 32 bits; beyond, they have 32 each
constexpr int k_longest_short_string = 16383;
constexpr int k_words_of_value = 2;

/// Successive rows of one column.
struct RowString {
  int row = 0;
  std::vector<double> values = {};
};

void append_record(std::string& bytes, const std::string& record) {
  const auto size = static_cast<std::int32_t>(record.size());
  append_value(bytes, size);
  bytes += record;
  append_value(bytes, size);
}

/// Of column `j` of the whole matrix, from 0.
std::vector<RowString> strings_of(const SparseMatrix& whole, int j, int longest) {
  std::vector<RowString> strings;
  for (SparseMatrix::InnerIterator entry(whole, j); entry; ++entry) {
    if (entry.value() == 0.0) continue;
    const auto row = static_cast<int>(entry.row());
    const bool follows = !strings.empty() && row == strings.back().row + std::ssize(strings.back().values) &&
                         std::ssize(strings.back().values) < longest;
    if (!follows) strings.push_back({.row = row});
    strings.back().values.push_back(entry.value());
  }
  return strings;
}

std::string column_record(const std::vector<RowString>& strings, int j, bool is_big) {
  std::string body;
  for (const RowString& string : strings) {
    const auto words = static_cast<std::int32_t>(k_words_of_value * string.values.size()) + 1;
    const std::int32_t row = string.row + 1;
    append_value(body, is_big ? words : row + 65536 * words);
    if (is_big) append_value(body, row);
    for (const double value : string.values) append_value(body, value);
  }
  std::string record;
  append_value(record, std::int32_t{j + 1});
  append_value(record, std::int32_t{0});
  append_value(record, static_cast<std::int32_t>(body.size() / sizeof(std::int32_t)));
  return record + body;
}

}  // namespace

std::string matrix_market_text(const SparseMatrix& lower) {
  std::string text = "%%MatrixMarket matrix coordinate real symmetric\n";
  fmt::format_to(std::back_inserter(text), "{} {} {}\n", lower.rows(), lower.cols(), lower.nonZeros());
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      fmt::format_to(std::back_inserter(text), "{} {} {}\n", entry.row() + 1, j + 1, entry.value());
    }
  }
  return text;
}

std::string output4_bytes(const SparseMatrix& lower, const std::string& name) {
  const bool is_name =
      !name.empty() && name.size() <= k_name_length && name.front() >= 'A' && name.front() <= 'Z' &&
      std::all_of(name.begin(), name.end(), [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
  require(is_name, "matrix '{}': a name of Nastran's has 1 to 8 capitals and digits and begins with a capital", name);
  const SparseMatrix whole = lower.selfadjointView<Eigen::Lower>();
  const auto rows = static_cast<std::int32_t>(whole.rows());
  const bool is_big = rows > k_most_short_rows;
  constexpr std::int32_t k_symmetric = 6;
  constexpr std::int32_t k_double = 2;
  std::string bytes;
  std::string record;
  for (const std::int32_t number : {rows, is_big ? -rows : rows, k_symmetric, k_double}) append_value(record, number);
  append_record(bytes, record + name + std::string(k_name_length - name.size(), ' '));
  for (int j = 0; j < rows; ++j) {
    const std::vector<RowString> strings = strings_of(whole, j, is_big ? rows : k_longest_short_string);
    if (!strings.empty()) append_record(bytes, column_record(strings, j, is_big));
  }
  std::string end;  // a column behind the last, with a value of no meaning
  for (const std::int32_t number : {rows + 1, std::int32_t{1}, k_words_of_value}) append_value(end, number);
  append_value(end, 1.0);
  append_record(bytes, end);
  return bytes;
}

}  // namespace mottle::formats
