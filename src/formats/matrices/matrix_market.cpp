// Matrix Market exchange format. Source: [Boisvert1996].
#include "formats/matrices/matrix_readers.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

struct Header {
  bool is_dense = false;
  bool is_symmetric = false;
};

Header read_header(MatrixLines& text) {
  text.need("%%MatrixMarket matrix ...");
  Words words;
  const std::size_t count = split_words(text.line(), words);
  const auto word = [&](std::size_t i) { return i < count && i < k_max_words ? capitals(words[i]) : ""; };
  if (count != 5 || word(0) != "%%MATRIXMARKET" || word(1) != "MATRIX") {
    text.fail("expected '%%MatrixMarket matrix coordinate|array real|integer general|symmetric'");
  }
  const Header header{word(2) == "ARRAY", word(4) == "SYMMETRIC"};
  if (!header.is_dense && word(2) != "COORDINATE") {
    text.fail(fmt::format("format '{}' is not coordinate or array", words[2]));
  }
  if (word(3) != "REAL" && word(3) != "INTEGER" && word(3) != "DOUBLE") {
    text.fail(fmt::format("field '{}' is not read here; write the matrix as real", words[3]));
  }
  if (!header.is_symmetric && word(4) != "GENERAL") {
    text.fail(fmt::format("a stiffness or mass matrix is symmetric or general, not '{}'", words[4]));
  }
  return header;
}

/// The next line that is neither empty nor a comment; its words.
std::size_t next_words(MatrixLines& text, Words& words, std::string_view what) {
  for (;;) {
    text.need(what);
    if (text.line().starts_with('%')) continue;
    const std::size_t count = split_words(text.line(), words);
    if (count > 0) return count;
  }
}

long long whole(const MatrixLines& text, std::string_view word) {
  long long value = 0;
  if (!parse_whole(word, value)) text.fail(fmt::format("'{}' is not a whole number", word));
  return value;
}

double real(const MatrixLines& text, std::string_view word) {
  double value = 0.0;
  if (!parse_fortran(word, value)) text.fail(fmt::format("'{}' is not a finite number", word));
  return value;
}

}  // namespace

SymmetricMatrix parse_matrix_market(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  const Header header = read_header(text);
  Words words;
  const std::size_t sizes = next_words(text, words, "the size of the matrix");
  if (sizes != (header.is_dense ? 2U : 3U)) {
    text.fail(header.is_dense ? "expected rows and columns" : "expected rows, columns and number of entries");
  }
  SymmetricBuilder builder(file);
  const long long rows = whole(text, words[0]);
  builder.set_size(text.number(), rows, whole(text, words[1]));
  if (header.is_dense) {
    for (long long column = 1; column <= rows; ++column) {
      for (long long row = header.is_symmetric ? column : 1; row <= rows; ++row) {
        if (next_words(text, words, "another value") != 1) text.fail("expected one value a line");
        const double value = real(text, words[0]);
        if (value != 0.0) builder.add(text.number(), row, column, value);
      }
    }
  } else {
    const long long entries = whole(text, words[2]);
    for (long long k = 0; k < entries; ++k) {
      const std::string what = fmt::format("entry {} of {}", k + 1, entries);
      if (next_words(text, words, what) != 3) text.fail("expected row, column and value");
      const long long row = whole(text, words[0]);
      const long long column = whole(text, words[1]);
      if (header.is_symmetric && row < column) text.fail("a symmetric matrix is stored by its lower triangle");
      builder.add(text.number(), row, column, real(text, words[2]));
    }
  }
  while (text.next()) {
    if (split_words(text.line(), words) > 0) text.fail("stands after the last entry that the header counts");
  }
  return {.lower = builder.finish()};
}

}  // namespace mottle::formats
