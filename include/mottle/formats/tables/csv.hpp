// Tables of comma-separated values: bytes <-> named columns. Knows nothing of what the columns mean.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// A table as it stands in a file.
struct CsvTable {
  std::string file;  ///< for messages
  std::vector<std::string> header;
  bool has_header = true;                      ///< false: the file has none, and the columns are called "1", "2", ...
  std::vector<std::vector<std::string>> rows;  ///< as many cells as the header has
  std::vector<int> lines;                      ///< line of each row, counted from 1
  std::vector<int> numbers;                    ///< of each row, counted from 1, empty lines between rows counted too

  /// Index of a column, or -1.
  int find(std::string_view name) const;
};

/// Whether a table may begin with a row of numbers.
enum class HeaderRule : std::uint8_t { required, may_be_missing };

/// Reads a table. Separator: comma, semicolon or tab, whichever the header holds; cells may be quoted (""); CRLF,
/// byte-order mark, empty lines and lines that start with # are allowed.
///
/// @param bytes  the file's content
/// @param file   its name, for messages
/// @param rule   `may_be_missing`: a first line of numbers and missing values alone is a row, unless it counts 1, 2,
/// ...
/// @throws FormatError  no header, an empty or repeated column name, a row that is longer or shorter than the
///                      header, a quote that is not closed
CsvTable parse_csv(std::string_view bytes, const std::string& file, HeaderRule rule = HeaderRule::required);

/// Numbers of one column; an empty cell, "nan" and "NaN" mean not measured and become nan.
///
/// @throws FormatError  text where a number should be, an infinite number (names line and column)
Eigen::VectorXd numbers_of_column(const CsvTable& table, int column);

/// Writes header and rows with the shortest digits that read back exactly; nan becomes an empty cell
/// (the word nan where it stands alone on its line). `text_columns` follow the numbers.
std::string format_csv(const std::vector<std::string>& header, const Eigen::Ref<const Eigen::MatrixXd>& values,
                       const std::vector<std::vector<std::string>>& text_columns = {});

}  // namespace mottle::formats
