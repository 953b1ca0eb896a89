#include "formats/matrices/matrix_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace mottle::formats {
namespace {

constexpr long long k_max_rows = 10'000'000;
// Rows that a matrix may have whatever stands in it, and for each of its entries: a line must not claim gigabytes.
constexpr std::size_t k_free_rows = 1'000'000;
constexpr std::size_t k_rows_an_entry = 100;

}  // namespace

bool MatrixLines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

void MatrixLines::need(std::string_view what) {
  if (!next()) throw FormatError(file_, number_, fmt::format("the file ends here; expected {}", what));
}

std::size_t split_words(std::string_view line, Words& words, char separator) {
  const auto is_gap = [separator](char c) { return c == ' ' || c == '\t' || c == separator; };
  std::size_t count = 0;
  for (std::size_t i = 0; i < line.size();) {
    if (is_gap(line[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < line.size() && !is_gap(line[end])) ++end;
    if (count == k_max_words) return k_max_words + 1;
    words[count++] = line.substr(i, end - i);
    i = end;
  }
  return count;
}

std::string_view trim_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool parse_whole(std::string_view text, long long& value) {
  text = trim_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  constexpr long long k_largest = 1'000'000'000'000'000;  // far from where sums overflow
  return error == std::errc() && end == text.data() + text.size() && !text.empty() && value <= k_largest &&
         value >= -k_largest;
}

bool parse_fortran(std::string_view text, double& value) {
  text = trim_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.empty() || text.starts_with('+')) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return std::isfinite(value);
  // Less common: D for E, or an exponent of three digits or by its sign alone.
  constexpr std::size_t k_longest = 40;
  if (text.size() > k_longest) return false;
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_exponent = c == 'd' || c == 'D' || c == 'e' || c == 'E';
    const bool is_sign = c == '+' || c == '-';
    if (is_sign && i > 0 && plain.back() != 'e') plain += 'e';
    if (is_exponent) {
      plain += 'e';
    } else if (c != '+') {
      plain += c;
    }
  }
  const auto [stop, fault] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  return fault == std::errc() && stop == plain.data() + plain.size() && std::isfinite(value);
}

std::string row_name(long long node, int component) {
  constexpr std::array k_directions{"", ":+X", ":+Y", ":+Z", ":+RX", ":+RY", ":+RZ"};
  return fmt::format("{}{}", node, k_directions.at(static_cast<std::size_t>(component)));
}

void SymmetricBuilder::set_size(int line, long long rows, long long columns) {
  if (rows != columns) throw FormatError(file_, line, fmt::format("the matrix is {} x {}, not square", rows, columns));
  if (rows < 1) throw FormatError(file_, line, fmt::format("the matrix has {} rows, need at least 1", rows));
  if (rows > k_max_rows) {
    throw FormatError(file_, line, fmt::format("{} rows, more than the {} allowed", rows, k_max_rows));
  }
  size_ = static_cast<int>(rows);
}

void SymmetricBuilder::add(int line, long long row, long long column, double value) {
  if (is_growing_ && std::max(row, column) > size_) {
    const long long size = std::max(row, column);
    set_size(line, size, size);
  }
  if (row < 1 || column < 1 || row > size_ || column > size_) {
    throw FormatError(file_, line,
                      fmt::format("entry ({}, {}) is outside of the {} x {} matrix", row, column, size_, size_));
  }
  entries_.push_back({static_cast<int>(std::max(row, column)) - 1, static_cast<int>(std::min(row, column)) - 1,
                      row < column, line, value});
}

bool SymmetricBuilder::is_full(Stored stored) const {
  bool has_lower = false;
  bool has_upper = false;
  bool has_mirrors = false;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.row != entry.column) (entry.is_upper ? has_upper : has_lower) = true;
    if (i > 0 && entry.row == entries_[i - 1].row && entry.column == entries_[i - 1].column) has_mirrors = true;
  }
  return stored == Stored::pairs ? has_mirrors : has_lower && has_upper;
}

SparseMatrix SymmetricBuilder::finish(Stored stored) {
  if (size_ < 1) throw FormatError(file_, 0, "holds no matrix entry");
  if (static_cast<std::size_t>(size_) > k_free_rows + k_rows_an_entry * entries_.size()) {
    throw FormatError(
        file_, 0,
        fmt::format("a matrix of {} rows with {} entries: nearly all of its rows are empty", size_, entries_.size()));
  }
  std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  const bool full = is_full(stored);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size_);
  for (const Entry& entry : entries_) {
    if (entry.row == entry.column) diagonal(entry.row) = std::abs(entry.value);
  }
  SparseMatrix lower(size_, size_);
  lower.reserve(static_cast<Eigen::Index>(entries_.size()));
  int column = -1;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    while (column < entry.column) lower.startVec(++column);
    const auto is_same = [&](std::size_t k) {
      return k < entries_.size() && entries_[k].row == entry.row && entries_[k].column == entry.column;
    };
    double other = entry.row == entry.column || !full ? entry.value : 0.0;
    if (is_same(i + 1)) {
      const Entry& mirror = entries_[++i];
      if (mirror.is_upper == entry.is_upper || is_same(i + 1)) {
        throw FormatError(file_, mirror.line,
                          fmt::format("entry ({}, {}) is given twice", entry.row + 1, entry.column + 1));
      }
      other = mirror.value;
    }
    constexpr double k_asymmetry = 1e-9;
    const double size = std::max({diagonal(entry.row), diagonal(entry.column), std::abs(entry.value)});
    if (!(std::abs(entry.value - other) <= k_asymmetry * size)) {
      throw FormatError(file_, entry.line,
                        fmt::format("the matrix is not symmetric: entries ({0}, {1}) and ({1}, {0}) are {2} and {3}",
                                    entry.row + 1, entry.column + 1, entry.value, other));
    }
    lower.insertBackByOuterInner(column, entry.row) = entry.value == other ? other : 0.5 * (entry.value + other);
  }
  while (column + 1 < size_) lower.startVec(++column);
  lower.finalize();
  return lower;
}

}  // namespace mottle::formats
