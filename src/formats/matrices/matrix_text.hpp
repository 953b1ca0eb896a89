// Functions shared by the readers of matrices: lines, Fortran numbers, and assembly of a symmetric matrix by entries.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// The lines of a text, one after the other, and where a fault is.
class MatrixLines {
 public:
  MatrixLines(std::string_view bytes, std::string file) : rest_(bytes), file_(std::move(file)) {}

  /// Goes to the next line; false at the end.
  bool next();
  /// Goes to the next line; at the end a FormatError that says what is missing.
  void need(std::string_view what);

  std::string_view line() const { return line_; }  ///< without its end
  int number() const { return number_; }           ///< from 1
  const std::string& file() const { return file_; }
  [[noreturn]] void fail(const std::string& message) const { throw FormatError(file_, number_, message); }

 private:
  std::string_view rest_, line_;
  std::string file_;
  int number_ = 0;
};

constexpr std::size_t k_max_words = 8;
using Words = std::array<std::string_view, k_max_words>;

/// Splits at blanks, tabs and `separator`; the number of words, k_max_words + 1 where there are more.
std::size_t split_words(std::string_view line, Words& words, char separator = ' ');

/// A whole number that fills `text` (blanks around allowed); false where it does not.
bool parse_whole(std::string_view text, long long& value);
/// A number as Fortran writes it, 1.5D+07 and 1.5+07 included, not infinite; false where it is none.
bool parse_fortran(std::string_view text, double& value);

std::string_view trim_blanks(std::string_view text);

/// "101:+Z" for component 3 (1..6), "101" for component 0.
std::string row_name(long long node, int component);

/// Puts a symmetric matrix together from entries of one triangle or of both.
class SymmetricBuilder {
 public:
  /// Which entries a file holds, beside those of both triangles.
  enum class Stored {
    triangle,  ///< those of one
    pairs,     ///< each pair once, in any order of its rows
  };

  explicit SymmetricBuilder(std::string file) : file_(std::move(file)) {}

  /// Throws FormatError: not square, empty, more than ten million rows (what a file claims must not exhaust the
  /// memory).
  void set_size(int line, long long rows, long long columns);
  /// The size follows from the entries.
  void grow() { is_growing_ = true; }
  /// @param row, column  from 1
  /// Throws FormatError: outside of the matrix.
  void add(int line, long long row, long long column, double value);

  /// Throws FormatError: an entry twice, two triangles that disagree, more than a million rows that are nearly all
  /// empty.
  SparseMatrix finish(Stored stored = Stored::triangle);

 private:
  struct Entry {
    int row = 0, column = 0;  // row >= column
    bool is_upper = false;    // as it stood in the file
    int line = 0;
    double value = 0.0;
  };

  bool is_full(Stored stored) const;

  std::string file_;
  int size_ = 0;
  bool is_growing_ = false;
  std::vector<Entry> entries_;
};

}  // namespace mottle::formats
