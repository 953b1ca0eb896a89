// Matrices of Nastran's OUTPUT4, text and binary: dense columns, strings, and strings with BIGMAT headers.
// Source: [MSC2014], OUTPUT4.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "formats/matrices/matrix_readers.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

struct Header {
  long long columns = 0, rows = 0, form = 0, type = 0;
  std::string name;
  bool is_big = false;  ///< rows were negative: strings say length and row in two numbers
};

struct Entry {
  int line = 0;
  long long row = 0, column = 0;
  double value = 0.0;
};

/// One matrix after the other; what differs between text and binary is below.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}
  virtual ~Reader() = default;

  SymmetricMatrix read(const std::string& wanted) {
    std::vector<std::string> names;
    std::vector<std::vector<Entry>> matrices;
    std::vector<Header> headers;
    Header header;
    while (next_header(header)) {
      check(header);
      headers.push_back(header);
      names.push_back(header.name);
      matrices.emplace_back();
      read_columns(header, matrices.back());
    }
    const std::size_t chosen = choose_matrix(file_, wanted, names);
    constexpr long long k_double = 2;
    constexpr long long k_square = 1;
    constexpr long long k_symmetric = 6;
    const Header& head = headers[chosen];
    if (head.type > k_double) {
      fail(fmt::format("matrix '{}' is complex; a real one is read here", head.name));
    }
    if (head.form != k_square && head.form != k_symmetric) {
      fail(fmt::format("matrix '{}' has form {}; 6 (symmetric) or 1 (square) is read here", head.name, head.form));
    }
    SymmetricBuilder builder(file_);
    builder.set_size(0, head.rows, head.columns);
    for (const Entry& entry : matrices[chosen]) builder.add(entry.line, entry.row, entry.column, entry.value);
    return {.lower = builder.finish()};
  }

 protected:
  struct Column {
    long long number = 0, row = 0, words = 0;
  };
  /// False at the end of the file.
  virtual bool next_header(Header& header) = 0;
  virtual Column next_column() = 0;
  virtual long long whole_of_string(bool is_second) = 0;
  virtual double value(bool is_double, bool is_first) = 0;
  /// Nothing may be left of the column.
  virtual void end_column() = 0;
  virtual long long words_of_dense_value(const Header& header) const = 0;
  virtual int line() const { return 0; }
  static long long words_of_value(const Header& header) {
    constexpr long long k_words[] = {1, 2, 2, 4};
    return k_words[header.type - 1];
  }

  [[noreturn]] void fail(const std::string& message) const { throw FormatError(file_, line(), message); }

 private:
  void check(Header& header) {
    header.is_big = header.rows < 0;
    header.rows = std::abs(header.rows);
    constexpr long long k_last_type = 4;
    if (header.type < 1 || header.type > k_last_type || header.columns < 0) {
      fail(fmt::format("'{}' is not the header of an OUTPUT4 matrix: {} columns of type {}", header.name,
                       header.columns, header.type));
    }
  }

  void read_columns(const Header& header, std::vector<Entry>& entries) {
    long long last = 0;
    for (;;) {
      const Column column = next_column();
      const bool is_end = column.number == header.columns + 1;
      if (column.number <= last || column.number > header.columns + 1 || column.words < 0) {
        fail(fmt::format("column {} with {} words follows column {} of {}", column.number, column.words, last,
                         header.columns));
      }
      last = column.number;
      if (column.row == 0 && !is_end) {
        read_strings(header, column, entries);
      } else {
        const long long per_value = is_end ? 1 : words_of_dense_value(header);
        read_values(header, column.number, column.row, is_end ? 1 : column.words / per_value,
                    is_end ? nullptr : &entries);
      }
      end_column();
      if (is_end) return;
    }
  }

  void read_strings(const Header& header, const Column& column, std::vector<Entry>& entries) {
    constexpr long long k_shift = 65536;
    for (long long left = column.words; left > 0;) {
      long long length = whole_of_string(false);
      long long row = 0;
      if (header.is_big) {
        row = whole_of_string(true);
        left -= 2;
      } else {
        row = length % k_shift;
        length /= k_shift;
        left -= 1;
      }
      const long long words = length - 1;
      if (words < 1 || words > left) {
        fail(fmt::format("a string of {} words in column {}, where {} words are left", words, column.number, left));
      }
      read_values(header, column.number, row, words / words_of_value(header), &entries);
      left -= words;
    }
  }

  void read_values(const Header& header, long long column, long long row, long long count,
                   std::vector<Entry>* entries) {
    const bool is_double = header.type == 2 || header.type == 4;
    const bool is_complex = header.type > 2;
    for (long long k = 0; k < count * (is_complex && entries != nullptr ? 2 : 1); ++k) {
      const double found = value(is_double, k == 0);
      if (entries == nullptr || is_complex || found == 0.0) continue;
      if (!std::isfinite(found)) fail(fmt::format("column {} holds a value that is not finite", column));
      entries->push_back({line(), row + k, column, found});
    }
  }

  std::string file_;
};

/// Lines of whole numbers, and of values in fields of one width.
class TextReader final : public Reader {
 public:
  TextReader(std::string_view bytes, const std::string& file) : Reader(file), text_(bytes, file) {}

 private:
  static constexpr std::size_t k_field = 8;

  bool next_header(Header& header) override {
    do {
      if (!text_.next()) return false;
    } while (trim_blanks(text_.line()).empty());
    long long* const numbers[] = {&header.columns, &header.rows, &header.form, &header.type};
    for (std::size_t k = 0; k < 4; ++k) {
      if (text_.line().size() < (k + 1) * k_field ||
          !parse_whole(text_.line().substr(k * k_field, k_field), *numbers[k])) {
        text_.fail("expected the header of a matrix: four whole numbers in 8 columns each, a name and a format");
      }
    }
    const std::string rest = capitals(text_.line().substr(4 * k_field));
    header.name = std::string(trim_blanks(rest.substr(0, k_field)));
    const std::size_t format = rest.find(',');
    const std::size_t letter = format == std::string::npos ? format : rest.find_first_of("ED", format);
    const std::size_t point = letter == std::string::npos ? letter : rest.find('.', letter);
    long long width = 0;
    constexpr long long k_widest = 40;
    if (point == std::string::npos || !parse_whole(rest.substr(letter + 1, point - letter - 1), width) || width < 1 ||
        width > k_widest) {
      text_.fail("expected a format like 1P,3E23.16 behind the matrix's name");
    }
    width_ = static_cast<std::size_t>(width);
    return true;
  }

  Column next_column() override {
    text_.need("a column");
    Words words;
    Column column;
    if (split_words(text_.line(), words) != 3 || !parse_whole(words[0], column.number) ||
        !parse_whole(words[1], column.row) || !parse_whole(words[2], column.words)) {
      text_.fail("expected column, row and number of words");
    }
    return column;
  }

  long long whole_of_string(bool is_second) override {
    Words words;
    if (!is_second) text_.need("the head of a string");
    const std::size_t count = split_words(text_.line(), words);
    long long value = 0;
    if (count < 1 || count > 2 || (is_second && count != 2) || !parse_whole(words[is_second ? 1 : 0], value)) {
      text_.fail("expected the head of a string");
    }
    return value;
  }

  double value(bool, bool is_first) override {
    if (is_first || position_ >= text_.line().size()) {
      text_.need("more values");
      position_ = 0;
    }
    double found = 0.0;
    const std::string_view field = position_ < text_.line().size() ? text_.line().substr(position_, width_) : "";
    if (!parse_fortran(field, found)) text_.fail(fmt::format("'{}' is not a finite number", field));
    position_ += width_;
    return found;
  }

  void end_column() override {}
  long long words_of_dense_value(const Header& header) const override { return header.type > 2 ? 2 : 1; }
  int line() const override { return text_.number(); }

  MatrixLines text_;
  std::size_t width_ = 0;
  std::size_t position_ = 0;
};

/// Fortran's records: their size in bytes before and after what they hold.
class BinaryReader final : public Reader {
 public:
  BinaryReader(std::string_view bytes, const std::string& file)
      : Reader(file), rest_(bytes), is_swapped_(bytes[0] == 0) {}

 private:
  template <typename Number>
  Number take() {
    if (record_.size() < sizeof(Number)) fail_at("a record ends too early");
    std::array<char, sizeof(Number)> bytes;
    std::copy_n(record_.begin(), sizeof(Number), bytes.begin());
    record_.remove_prefix(sizeof(Number));
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<Number>(bytes);
  }

  [[noreturn]] void fail_at(const std::string& message) const {
    fail(fmt::format("{}, {} bytes before the end of the file", message, rest_.size() + record_.size()));
  }

  std::int32_t marker() {
    record_ = rest_.substr(0, sizeof(std::int32_t));
    const auto size = take<std::int32_t>();
    rest_.remove_prefix(sizeof(std::int32_t));
    return size;
  }

  void next_record() {
    const std::int32_t size = marker();
    if (size < 0 || static_cast<std::size_t>(size) + sizeof size > rest_.size()) {
      fail_at(fmt::format("a record of {} bytes is cut off", size));
    }
    const std::string_view body = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(body.size());
    if (marker() != size) fail_at("the sizes before and after a record differ");
    record_ = body;
  }

  bool next_header(Header& header) override {
    if (rest_.empty()) return false;
    constexpr std::size_t k_bytes = 24;
    next_record();
    if (record_.size() != k_bytes) fail_at(fmt::format("the header of a matrix has {} bytes, not 24", record_.size()));
    for (long long* number : {&header.columns, &header.rows, &header.form, &header.type})
      *number = take<std::int32_t>();
    header.name = capitals(trim_blanks(record_));
    return true;
  }

  Column next_column() override {
    next_record();
    Column column;
    for (long long* number : {&column.number, &column.row, &column.words}) *number = take<std::int32_t>();
    return column;
  }

  long long whole_of_string(bool) override { return take<std::int32_t>(); }
  double value(bool is_double, bool) override {
    return is_double ? take<double>() : static_cast<double>(take<float>());
  }
  void end_column() override {
    record_ = {};  // the last column holds a number of no meaning, in as many bytes as the writer liked
  }
  long long words_of_dense_value(const Header& header) const override { return words_of_value(header); }

  std::string_view rest_, record_;
  bool is_swapped_;
};

}  // namespace

SymmetricMatrix parse_output4(std::string_view bytes, const std::string& file, const std::string& name) {
  const bool is_binary = bytes.substr(0, 4).find('\0') != std::string_view::npos;
  if (is_binary) return BinaryReader(bytes, file).read(name);
  return TextReader(bytes, file).read(name);
}

}  // namespace mottle::formats
