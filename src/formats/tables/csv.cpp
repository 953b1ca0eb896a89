#include "mottle/formats/tables/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

constexpr std::string_view k_byte_order_mark = "\xEF\xBB\xBF";

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

char find_separator(std::string_view header) {
  std::string unquoted;
  bool is_quoted = false;
  for (const char c : header) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted) unquoted += c;
  }
  for (const char separator : {';', '\t'}) {
    if (unquoted.find(separator) != std::string::npos) return separator;
  }
  return ',';
}

std::vector<std::string> split_line(std::string_view line, char separator, const std::string& file, int number) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      const bool is_literal = is_quoted && i + 1 < line.size() && line[i + 1] == '"';
      if (is_literal) {
        cells.back() += '"';
        ++i;
      } else {
        is_quoted = !is_quoted;
      }
    } else if (c == separator && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  if (is_quoted) throw FormatError(file, number, "a quoted cell is not closed on its line");
  for (std::string& cell : cells) cell = std::string(trim(cell));
  return cells;
}

void require_good_header(const CsvTable& table, int line) {
  std::set<std::string_view> names;
  for (const std::string& name : table.header) {
    if (name.empty()) throw FormatError(table.file, line, fmt::format("column {} has no name", names.size() + 1));
    if (!names.insert(name).second)
      throw FormatError(table.file, line, fmt::format("column '{}' is given twice", name));
  }
}

bool is_missing(std::string_view cell) {
  return cell.empty() || cell == "nan" || cell == "NaN" || cell == "NAN";
}

/// Whether the cells are numbers or missing, and not the numbers of the columns.
bool is_row_of_numbers(const std::vector<std::string>& cells) {
  bool counts = true;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    double number = 0.0;
    if (!is_missing(cells[k]) && !parse_number(cells[k], number)) return false;
    counts = counts && !is_missing(cells[k]) && number == static_cast<double>(k + 1);
  }
  return !counts;
}

std::string quoted_if_needed(const std::string& cell) {
  const bool is_skipped_at_a_start = cell.starts_with('#') || cell.starts_with(k_byte_order_mark);
  if (!is_skipped_at_a_start && cell.find_first_of(",;\"\n\t") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + '"';
}

}  // namespace

int CsvTable::find(std::string_view name) const {
  const auto found = std::find(header.begin(), header.end(), name);
  return found == header.end() ? -1 : static_cast<int>(std::distance(header.begin(), found));
}

CsvTable parse_csv(std::string_view bytes, const std::string& file, HeaderRule rule) {
  if (bytes.starts_with(k_byte_order_mark)) bytes.remove_prefix(k_byte_order_mark.size());
  CsvTable table;
  table.file = file;
  char separator = ',';
  int count = 0;
  for (int number = 1; !bytes.empty(); ++number) {
    const std::size_t end = bytes.find('\n');
    const std::string_view line = trim(bytes.substr(0, end));
    // A line of tabs alone is a row of missing values; trimming must not eat it.
    const std::string_view raw = bytes.substr(0, end);
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    const bool is_row_of_tabs = separator == '\t' && raw.find('\t') != std::string_view::npos;
    if (line.starts_with('#')) continue;
    if (line.empty() && !is_row_of_tabs) {
      if (!table.header.empty()) ++count;
      continue;
    }
    if (table.header.empty()) {
      separator = find_separator(line);
      table.header = split_line(separator == '\t' ? raw : line, separator, file, number);
      table.has_header = rule == HeaderRule::required || !is_row_of_numbers(table.header);
      if (table.has_header) {
        require_good_header(table, number);
        continue;
      }
      for (std::size_t k = 0; k < table.header.size(); ++k) table.header[k] = fmt::format("{}", k + 1);
    }
    std::vector<std::string> cells = split_line(separator == '\t' ? raw : line, separator, file, number);
    if (cells.size() != table.header.size()) {
      throw FormatError(file, number,
                        fmt::format("{} cells, but the header names {} columns", cells.size(), table.header.size()));
    }
    table.rows.push_back(std::move(cells));
    table.lines.push_back(number);
    table.numbers.push_back(++count);
  }
  if (table.header.empty()) throw FormatError(file, 0, "is empty; a header line with column names is needed");
  return table;
}

Eigen::VectorXd numbers_of_column(const CsvTable& table, int column) {
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(table.rows.size()));
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& cell = table.rows[row][static_cast<std::size_t>(column)];
    double& number = numbers(static_cast<Eigen::Index>(row));
    if (is_missing(cell)) {
      number = std::numeric_limits<double>::quiet_NaN();
    } else if (!parse_number(cell, number) || !std::isfinite(number)) {
      std::string with_point = cell;
      std::ranges::replace(with_point, ',', '.');
      const bool has_comma = with_point != cell && parse_number(with_point, number);
      throw FormatError(table.file, table.lines[row],
                        fmt::format("column '{}' holds '{}', which is not a finite number; {}",
                                    table.header[static_cast<std::size_t>(column)], cell,
                                    has_comma ? "decimal commas are not read: write a point"
                                              : "leave the cell empty where nothing was measured"));
    }
  }
  return numbers;
}

std::string format_csv(const std::vector<std::string>& header, const Eigen::Ref<const Eigen::MatrixXd>& values,
                       const std::vector<std::vector<std::string>>& text_columns) {
  std::vector<std::string> names;
  for (const std::string& name : header) names.push_back(quoted_if_needed(name));
  std::string text = join(names, ",") + '\n';
  auto out = std::back_inserter(text);
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    const std::size_t start = text.size();
    for (Eigen::Index column = 0; column < values.cols(); ++column) {
      if (column > 0) text += ',';
      if (!std::isnan(values(row, column))) fmt::format_to(out, "{}", values(row, column));
    }
    for (const auto& column : text_columns) text += ',' + quoted_if_needed(column[static_cast<std::size_t>(row)]);
    if (text.size() == start) text += "nan";  // an empty line would be no row
    text += '\n';
  }
  return text;
}

}  // namespace mottle::formats
