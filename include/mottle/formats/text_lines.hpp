// Walks through the lines of a text and the words of a line, for files that programs print.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mottle/core/files.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// Longest line that is read of a file, in bytes.
inline constexpr std::size_t k_longest_line = std::size_t{16} << 20;

/// Line after line, without its end (LF or CRLF), of a text in memory or of a file. Of a file no more than a block and
/// a line are in memory at a time, however large it is.
class LineWalker {
 public:
  explicit LineWalker(std::string_view bytes) : rest_(bytes) {}
  /// @param name  what messages call the file
  LineWalker(BlockReader file, std::string name) : file_(std::move(file)), name_(std::move(name)) {}

  /// Moves to the next line; false at the end. Throws what BlockReader throws; FormatError: a line of a file is longer
  /// than k_longest_line.
  bool next();
  std::string_view line() const { return line_; }  ///< until the next one
  int number() const { return number_; }           ///< counted from 1

 private:
  bool read_more();
  void check_length(std::size_t size) const;

  std::optional<BlockReader> file_;  // until its end was read
  std::string name_;
  std::vector<char> buffer_;  // of a file: the bytes that line_ and rest_ show
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

}  // namespace mottle::formats
