// Walks through the lines of a text and the words of a line, for files that programs print.
#pragma once

#include <string_view>
#include <vector>

namespace mottle {

/// Line after line, without its end (LF or CRLF).
class LineWalker {
 public:
  explicit LineWalker(std::string_view bytes) : rest_(bytes) {}
  /// Moves to the next line; false at the end.
  bool next();
  std::string_view line() const { return line_; }
  int number() const { return number_; }  ///< counted from 1

 private:
  std::string_view rest_;
  std::string_view line_;
  int number_ = 0;
};

/// What blanks and tabs separate.
std::vector<std::string_view> words_of(std::string_view line);

/// A finite number that fills `text`; exponents with D (Fortran) are read too.
bool parse_printed_number(std::string_view text, double& value);

/// A whole number that fills `text`.
bool parse_whole_number(std::string_view text, int& value);

}  // namespace mottle
