// Reads a universal file line by line: dataset marks, records of numbers, binary payloads; every fault is reported with
// file and line.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// A record's fields by their columns.
using UffWidths = std::initializer_list<int>;

class UffCursor {
 public:
  UffCursor(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  /// Whether nothing but blank lines follows (they are passed).
  bool at_end();
  /// Whether the next line is a mark, "    -1".
  bool at_mark() const;
  /// The next line, whatever it is.
  std::string_view any_line();
  /// The next line of a dataset. Throws where the dataset or the file ends before `what`.
  std::string_view line(std::string_view what);
  std::string text(std::string_view what);

  /// Numbers of the next line: separated by blanks where there are `needed`, else by columns, in which blank is 0.
  /// Where the line is short, the rest is 0.
  std::vector<double> numbers(std::string_view what, UffWidths widths, std::size_t needed);
  /// The same of whole numbers.
  std::vector<int> integers(std::string_view what, UffWidths widths, std::size_t needed);
  /// `count` numbers on as many lines as they take, none missing; widths repeat along a line.
  std::vector<double> values(std::string_view what, UffWidths widths, std::size_t count);

  /// Takes bytes that are no text. Throws where there are fewer.
  std::string_view take(std::size_t count);
  std::size_t left() const { return bytes_.size() - position_; }
  std::string_view rest() const { return bytes_.substr(position_); }
  std::size_t position() const { return position_; }

  /// Line last taken, counted from 1.
  int line_number() const { return line_; }
  /// Throws FormatError about the line last taken.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view peek() const;
  std::vector<double> split(std::string_view line, std::string_view what, UffWidths widths, std::size_t needed) const;

  std::string_view bytes_;
  const std::string& file_;
  std::size_t position_ = 0;
  int line_ = 0;
};

/// The text of some columns, without the blanks around it.
std::string uff_columns(std::string_view line, std::size_t start, std::size_t width);

}  // namespace mottle::formats
